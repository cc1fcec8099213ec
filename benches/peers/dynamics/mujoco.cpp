#include <mujoco/mujoco.h>
#include "timing.hpp"

int main(int count, char** gaits) {
  for (int g = 1; g < count; g++) {
    char error[500];
    mjModel* m = mj_loadXML((std::string(gaits[g]) + ".xml").c_str(), nullptr, error, sizeof error);
    if (!m) { fprintf(stderr, "%s\n", error); return 1; }
    mjData* d = mj_makeData(m);
    Random random;
    std::vector<std::vector<double>> q(POOL), v(POOL);
    for (int i = 0; i < POOL; i++) for (int k = 0; k < m->nv; k++) { q[i].push_back(random(1.2)); v[i].push_back(random(5.0)); }
    time(gaits[g], "A + H", [&](int i) {
      std::copy(q[i].begin(), q[i].end(), d->qpos);
      std::copy(v[i].begin(), v[i].end(), d->qvel);
      mj_kinematics(m, d); mj_comPos(m, d); mj_makeM(m, d); mj_comVel(m, d); mj_rne(m, d, 0, d->qfrc_bias);
    });
    mj_deleteData(d);
    mj_deleteModel(m);
  }
}
