use piaffe::*; use piaffe::sqp::*; use piaffe::search::*; use piaffe::motion::*;
fn main(){
  let a:Vec<String>=std::env::args().collect();
  let gait=gaits::GAITS.iter().find(|g|g.description().gait==a[1]).copied().unwrap();
  let crit=if a[2]=="energy"{Criterion::Energy}else{Criterion::Torque};
  let k:usize=a.get(3).and_then(|s|s.parse().ok()).unwrap_or(0);
  let th=multi_start::start(gait,crit,0.6,1,k);
  let mut c=cycle::Cycle::new(gait,crit,0.6);
  let o=local::options(&c);
  let s=minimize(&mut c,&th,&o,&mut |i|{println!("{:3} f {:12.6} viol {:.2e} stat {:.2e} step {:.3} len {:.2e} pen {:.2e} act {} rows {} {:?}",i.k,i.objective,i.violation,i.stationarity,i.step,i.length,i.penalty,i.active,i.rows,i.kind);Control::Continue});
  println!("{:?} {} ev {}",s.status,s.objective,s.evaluations);
}
