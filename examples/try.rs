use piaffe::*; use piaffe::sqp::*; use piaffe::search::guess::*; use piaffe::motion::*; use std::time::Instant;
fn main(){
  let seeds:u64=std::env::args().nth(1).and_then(|s|s.parse().ok()).unwrap_or(5);
  for gait in gaits::GAITS { for crit in Criterion::ALL {
    let d=gait.description();
    let mut best=f64::INFINITY;
    for seed in 0..seeds {
      let mut rng=fastrand::Rng::with_seed(seed);
      let plan= if seed==0 {Plan::default_for(d)} else {Plan::random(d,&mut rng)};
      let mut c=cycle::Cycle::new(*gait,crit,0.6);
      let x0=c.theta(&walk(*gait,&plan,0.6));
      let mut o=Options::default(); o.scale=Some(c.scale()); 
      let t=Instant::now();
      let s=minimize(&mut c,&x0,&o,&mut |it| { if std::env::var("V").is_ok(){println!("{:?}",it);} Control::Continue});
      if s.status.is_optimal(){best=best.min(s.objective);}
      println!("{} {:?} seed {seed}: {:?} f {:.5} it {} ev {} ip {} kkt {:.1e} viol {:.1e} {:.1} ms",d.gait,crit,s.status,s.objective,s.iterations,s.evaluations,s.interior_solves,s.kkt.stationarity,s.kkt.violation,t.elapsed().as_secs_f64()*1e3);
    }
    println!("   best {best}");
  }}
}
