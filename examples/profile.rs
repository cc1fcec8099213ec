use piaffe::*; use piaffe::sqp::*; use piaffe::search::*; use piaffe::motion::*; use std::time::Instant;
fn main(){
  let a:Vec<String>=std::env::args().collect();
  let reps:usize=a.get(3).and_then(|s|s.parse().ok()).unwrap_or(10);
  for gait in gaits::GAITS { for crit in Criterion::ALL {
    if a.len()>1 && a[1]!="all" && (gait.description().gait!=a[1] || crit.name()!=a[2]) {continue}
    let th=multi_start::start(*gait,crit,0.6,1,0);
    let mut c=cycle::Cycle::new(*gait,crit,0.6);
    let o=local::options(&c);
    // pieces
    let mut v=Values::zeros(c.equalities(),c.inequalities());
    let t=Instant::now(); for _ in 0..200 {c.evaluate(&th,&mut v).unwrap();} let te=t.elapsed().as_secs_f64()/200.*1e6;
    let t=Instant::now(); for _ in 0..200 {c.linearize(&th).unwrap();} let tl=t.elapsed().as_secs_f64()/200.*1e6;
    let mut row=vec![0.;th.len()]; let m=c.inequalities();
    let t=Instant::now(); for i in 0..m {c.inequality_row(i,&mut row);} let tr=t.elapsed().as_secs_f64()*1e6;
    let mut out=vec![0.;m]; let dir=vec![0.1;th.len()];
    let t=Instant::now(); for _ in 0..20 {c.inequality_directions(&dir,&mut out);} let td=t.elapsed().as_secs_f64()/20.*1e6;
    let mut best=1e9f64; let mut it=0; let mut ev=0; let mut f=0.;let mut st=Status::Optimal; let mut rows=0;
    for _ in 0..reps { let t=Instant::now(); rows=0; let s=minimize(&mut c,&th,&o,&mut |i|{rows+=i.rows;Control::Continue}); best=best.min(t.elapsed().as_secs_f64()*1e3); it=s.iterations; ev=s.evaluations; f=s.objective;st=s.status;}
    let t=Instant::now(); let l=local::descend(*gait,crit,0.6,&th,&mut |_|Control::Continue); let tot=t.elapsed().as_secs_f64()*1e3;
    let t=Instant::now(); let r=verify::verify(gait.description(),&l.motion,0.6,2001).unwrap(); let tv=t.elapsed().as_secs_f64()*1e3;
    println!("{:7}{:8?} eval {te:.0} lin {tl:.0} rows {m} all {tr:.0} dirs {td:.0} us | {st:?} {f:.5} it {it} ev {ev} rows/it {} best {best:.2} ms | descend {tot:.2} it {} verify {tv:.2} viol {:.1e}",gait.description().gait,crit,rows/it.max(1),l.iterations,r.max_violation);
  }}
}
