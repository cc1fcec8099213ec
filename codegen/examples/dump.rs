use piaffe_codegen::*;
fn main(){
  let f=|p:&str| SpecFile{path:p.into(),text:std::fs::read_to_string(format!("/work/main/model-spec/{p}")).unwrap()};
  let t=std::time::Instant::now();
  match generate(&f("robot.toml"),&[f("gaits/trot.toml"),f("gaits/amble.toml"),f("gaits/curvet.toml")],"crate::model"){
    Ok(v)=>for (n,s) in v{ println!("{n} {}",s.len()); std::fs::write(format!("/tmp/gen_{n}"),s).unwrap();},
    Err(e)=>println!("{e}")}
  println!("{:?}",t.elapsed());
}
