#include "tests/bench/cvode_peer.hpp"

#include <algorithm>
#include <cmath>

#include "sim/plant/pouch.hpp"

#ifdef BIOPSY_SUNDIALS
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#endif

namespace biopsy::bench {

#ifdef BIOPSY_SUNDIALS
namespace {

struct Problem {
  const sim::Baseline& b;
  double mass_A;
  double u_start, t_start;  // stack voltage at the last change of the input
};

double stack_voltage(const Problem& p, double t) {
  return p.u_start * std::exp(-(t - p.t_start) / p.b.tau);
}

// H, x, v. The loop through the spring's damper by Newton's method, as in sim/plant/plant.cpp but to
// convergence.
int rates(double t, N_Vector state, N_Vector rate, void* data) {
  const Problem& p = *static_cast<const Problem*>(data);
  const sim::Baseline& b = p.b;
  const double* y = NV_DATA_S(state);
  double* dy = NV_DATA_S(rate);
  const double P = sim::pressure(b, stack_voltage(p, t));
  const double undamped = p.mass_A * b.g + b.k * (b.n * (y[0] - b.H_0) - y[1]) - b.c_k * y[2];
  double spring = std::max(0.0, undamped), dH = 0.0;
  for (int i = 0; i < 3; ++i) {
    const sim::Equilibrium goal = sim::equilibrium(b, P, spring + b.m_B * b.g);
    dH = (goal.H - y[0]) / b.tau_h;
    const double residual = std::max(0.0, undamped + b.c_k * b.n * dH) - spring;
    if (std::abs(residual) < 1e-12) break;
    spring = std::max(0.0, spring + residual / (1.0 - b.c_k * b.n * goal.slope / b.tau_h));
  }
  dy[0] = dH;
  dy[1] = y[2];
  dy[2] = (spring - p.mass_A * b.g - b.c_s * y[2]) / p.mass_A;
  return 0;
}

// CVODE and what belongs to it, freed together.
struct Solver {
  SUNContext context = nullptr;
  N_Vector state = nullptr;
  SUNNonlinearSolver iteration = nullptr;
  void* memory = nullptr;

  Solver(Problem& problem, const PeerSettings& settings) {
#ifdef SUN_COMM_NULL  // from SUNDIALS 7
    SUNContext_Create(SUN_COMM_NULL, &context);
#else
    SUNContext_Create(nullptr, &context);
#endif
    state = N_VNew_Serial(3, context);
    NV_Ith_S(state, 0) = problem.b.H_0;
    NV_Ith_S(state, 1) = NV_Ith_S(state, 2) = 0.0;
    memory = CVodeCreate(CV_ADAMS, context);
    CVodeInit(memory, rates, 0.0, state);
    CVodeSStolerances(memory, settings.relative, settings.absolute);
    CVodeSetUserData(memory, &problem);
    iteration = SUNNonlinSol_FixedPoint(state, 0, context);
    CVodeSetNonlinearSolver(memory, iteration);
    CVodeSetMaxNumSteps(memory, 1'000'000);
  }
  ~Solver() {
    CVodeFree(&memory);
    SUNNonlinSolFree(iteration);
    N_VDestroy(state);
    SUNContext_Free(&context);
  }
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;
};

}  // namespace

bool cvode_is_there() {
  return true;
}

std::vector<double> cvode_run(const sim::Baseline& baseline, double weight,
                              const std::vector<double>& voltage, const PeerSettings& settings) {
  Problem problem{baseline, baseline.fixture_mass + weight, 0.0, 0.0};
  Solver solver(problem, settings);
  std::vector<double> x;
  double u_i = 0.0, t = 0.0;
  for (std::size_t k = 0; k < voltage.size(); ++k) {
    const double now = static_cast<double>(k) * 1e-3, next = static_cast<double>(k + 1) * 1e-3;
    if (voltage[k] != u_i || k == 0 || settings.every_tick) {
      problem.u_start = stack_voltage(problem, now) + baseline.K * (voltage[k] - u_i);
      problem.t_start = now;
      u_i = voltage[k];
      CVodeReInit(solver.memory, now, solver.state);
      std::size_t jump = k + 1;  // where it must not look beyond
      while (!settings.every_tick && jump < voltage.size() && voltage[jump] == u_i) ++jump;
      CVodeSetStopTime(solver.memory, static_cast<double>(jump) * 1e-3);
    }
    if (CVode(solver.memory, next, solver.state, &t, CV_NORMAL) < 0) return {};
    x.push_back(NV_Ith_S(solver.state, 1));
  }
  return x;
}
#else
bool cvode_is_there() {
  return false;
}
std::vector<double> cvode_run(const sim::Baseline&, double, const std::vector<double>&, const PeerSettings&) {
  return {};
}
#endif

}  // namespace biopsy::bench
