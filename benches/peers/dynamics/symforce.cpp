#include <Eigen/Core>
#include "timing.hpp"

template <int N, class F> void run(const char* gait, F call) {
  using Vector = Eigen::Matrix<double, N, 1>;
  Random random;
  std::vector<Vector> x(POOL), v(POOL);
  for (int i = 0; i < POOL; i++) for (int k = 0; k < N; k++) { x[i][k] = random(1.2); v[i][k] = random(5.0); }
  Eigen::Matrix<double, N, N> A;
  Vector H;
  time(gait, "A + H", [&](int i) { call(x[i], v[i], A, H); });
}
#include "symforce_list.hpp"

int main() { run_all(); }
