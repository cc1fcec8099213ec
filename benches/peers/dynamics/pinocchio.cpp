// Header-only, so that it is compiled for this machine.
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include "timing.hpp"
namespace pin = pinocchio;
using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

struct Body { int parent, coordinate, axis; double offset[3], mass, com[3], inertia[9]; };
struct Mechanism { const char* gait; double gravity; int positions, rotation; std::vector<Body> bodies; };
#include "mechanisms.hpp"

static pin::Model build(const Mechanism& m) {
  pin::Model model;
  model.gravity.linear() = Vector3(0, -m.gravity, 0);
  const auto here = pin::SE3::Identity();
  pin::JointIndex last = model.addJoint(0, pin::JointModelPX(), here, "x");
  last = model.addJoint(last, pin::JointModelPY(), here, "y");
  if (m.positions == 3) last = model.addJoint(last, pin::JointModelPZ(), here, "z");
  if (m.rotation == 2) last = model.addJoint(last, pin::JointModelRZ(), here, "theta");
  if (m.rotation == 1) last = model.addJoint(last, pin::JointModelRX(), here, "theta");
  std::vector<pin::JointIndex> joints;
  for (const Body& b : m.bodies) {
    const auto at = pin::SE3(Matrix3::Identity(), Vector3(b.offset[0], b.offset[1], b.offset[2]));
    joints.push_back(b.parent < 0 ? last : model.addJoint(joints[b.parent], pin::JointModelRZ(), at, "q" + std::to_string(b.coordinate)));
    Matrix3 inertia;
    for (int k = 0; k < 9; k++) inertia(k / 3, k % 3) = b.inertia[k];
    model.appendBodyToJoint(joints.back(), pin::Inertia(b.mass, Vector3(b.com[0], b.com[1], b.com[2]), inertia), here);
  }
  return model;
}

int main() {
  for (const Mechanism& m : MECHANISMS) {
    pin::Model model = build(m);
    pin::Data data(model);
    Random random;
    std::vector<Eigen::VectorXd> q(POOL), v(POOL), a(POOL);
    for (int i = 0; i < POOL; i++) {
      Eigen::VectorXd d(model.nv), r(model.nv), s(model.nv);
      for (int k = 0; k < model.nv; k++) { d[k] = random(1.2); r[k] = random(5.0); s[k] = random(60.0); }
      q[i] = pin::integrate(model, pin::neutral(model), d);
      v[i] = r;
      a[i] = s;
    }
    time(m.gait, "A + H", [&](int i) { pin::crba(model, data, q[i], pin::Convention::LOCAL); pin::nonLinearEffects(model, data, q[i], v[i]); });
    time(m.gait, "inverse dynamics", [&](int i) { pin::rnea(model, data, q[i], v[i], a[i]); });
    time(m.gait, "inverse dynamics with Jacobian", [&](int i) { pin::computeRNEADerivatives(model, data, q[i], v[i], a[i]); });
  }
}
