#include "core/billiard/tangent_frame.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/arithmetic/elementary_functions.h"
#include "core/billiard/tangent_map.h"

namespace ballpiston {
namespace {

// In four wall hits lengths grow by some hundreds. The smallest vector loses the square of this
// factor in precision.
constexpr uint64_t kHitsTogether = 4;

// The sums are written out, because a library may reorder them or contract operations, and then
// other processors would have other bits.
double Dot(const std::array<double, 6>& a, const std::array<double, 6>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

TangentFrame::TangentFrame(const PairGeometry& geometry, const PairState& start)
    : rho_(geometry.rho()) {
  const double ux = start.direction.x(), uy = start.direction.y();
  const double v = start.ball_speed, p = start.piston_velocity;
  tangents_ = {{{0, 0, 0, -uy, ux, 0},
                {0, 0, 0, p * ux, p * uy, -v},
                {v * ux, v * uy, p, 0, 0, 0},
                {0, 0, 0, v * ux, v * uy, p},
                {-uy, ux, 0, 0, 0, 0},
                {p * ux, p * uy, -v, 0, 0, 0}}};
}

void TangentFrame::Follow(const Event& event, const PairState& after) {
  for (Tangent& tangent : tangents_) {
    for (size_t i = 0; i < 3; ++i) tangent[i] += event.duration * tangent[i + 3];
  }
  if (event.kind == EventKind::kPistonWall) ReflectPiston();
  if (event.kind != EventKind::kBallWall) return;
  ReflectBall(after);
  if (++hits_ == kHitsTogether) Orthonormalise();
}

void TangentFrame::Collide(const Collision&) {
  for (Tangent& tangent : tangents_) {
    std::swap(tangent[0], tangent[2]);
    std::swap(tangent[3], tangent[5]);
  }
  Orthonormalise();
}

std::array<double, TangentFrame::kExponents> TangentFrame::TakeGrowth() {
  return std::exchange(growth_, {});
}

// The disc is the one in the ball's quadrant, n its normal. With the unit tangent t = (-n_y, n_x)
// and the direction u = cos(phi) n + sin(phi) t after the hit, s = dr.t + tan(phi) dr.n.
void TangentFrame::ReflectBall(const PairState& after) {
  const double ux = after.direction.x(), uy = after.direction.y();
  const double nx = (after.position.x() - std::copysign(0.5, after.position.x())) / rho_;
  const double ny = (after.position.y() - std::copysign(0.5, after.position.y())) / rho_;
  const double cosine = std::max(nx * ux + ny * uy, kSmallestCosine<double>);
  const double tangent_of_phi = (nx * uy - ny * ux) / cosine;
  const double kick = 2 * after.ball_speed / rho_;
  for (auto& [x, y, q, vx, vy, p] : tangents_) {
    const double dr_n = x * nx + y * ny, dr_t = y * nx - x * ny, dw_n = vx * nx + vy * ny;
    const double turn = kick * (dr_t + tangent_of_phi * dr_n);
    x -= 2 * dr_n * nx;
    y -= 2 * dr_n * ny;
    vx -= 2 * dw_n * nx + turn * uy;
    vy -= 2 * dw_n * ny - turn * ux;
  }
}

void TangentFrame::ReflectPiston() {
  for (Tangent& tangent : tangents_) {
    tangent[2] = -tangent[2];
    tangent[5] = -tangent[5];
  }
}

void TangentFrame::Orthonormalise() {
  hits_ = 0;
  for (size_t k = 0; k < tangents_.size(); ++k) {
    Tangent& tangent = tangents_[k];
    for (size_t before = 0; before < k; ++before) {
      const double share = Dot(tangents_[before], tangent);
      for (size_t i = 0; i < tangent.size(); ++i) tangent[i] -= share * tangents_[before][i];
    }
    const double length = std::sqrt(Dot(tangent, tangent));
    growth_[k] += Log(length);
    for (double& component : tangent) component /= length;
  }
}

}  // namespace ballpiston
