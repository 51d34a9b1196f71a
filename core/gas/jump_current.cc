#include "core/gas/jump_current.h"

#include "core/conductivity/conductivity.h"
#include "core/gas/gas_meter.h"
#include "core/statistics/lag_products.h"

namespace ballpiston {
namespace {

const ContactCurrentsTable& TableOf(const GasGeometry& geometry) {
  return geometry.shape().is_lattice ? ContactCurrentsTable::OfLattice()
                                     : ContactCurrentsTable::OfChain();
}

double SignAlongX(Direction direction) { return IsAlongX(direction) ? SignOf(direction) : 0; }

}  // namespace

JumpCurrent::JumpCurrent(const GasGeometry& geometry, double exchange_rate, const GasState& start,
                         double duration)
    : table_(TableOf(geometry)),
      directions_(static_cast<size_t>(geometry.directions())),
      bound_(geometry.shape().columns > 1 ? table_.test_function().bound : 0),
      density_(exchange_rate / kContactRate),
      balls_(start.balls.size()),
      pistons_(start.pistons.size()),
      steps_(duration, kCurrentSteps),
      steps_left_(duration, kCurrentSteps) {
  const TestFunction& f = table_.test_function();
  for (size_t i = 0; i < balls_.size(); ++i) balls_[i].energy = EnergyOf(start.balls[i]);
  for (size_t i = 0; i < pistons_.size(); ++i) pistons_[i].energy = EnergyOf(start.pistons[i]);
  for (Body& ball : balls_) ball.values = f.OfBall(ball.energy);
  for (Body& piston : pistons_) piston.values = f.OfPiston(piston.energy);
  Connect(geometry);
  for (Contact& contact : contacts_) FindContact(contact);
  for (size_t ball = 0; ball < balls_.size(); ++ball) FindBallTerm(ball);
  for (size_t piston = 0; piston < pistons_.size(); ++piston) FindPistonTerm(piston);
}

void JumpCurrent::Connect(const GasGeometry& geometry) {
  sides_.resize(pistons_.size());
  for (int64_t ball = 0; ball < geometry.balls(); ++ball) {
    for (int i = 0; i < geometry.directions(); ++i) {
      const Direction direction = geometry.DirectionAt(i);
      const int64_t piston = geometry.PistonOf(ball, direction);
      sides_[static_cast<size_t>(piston)][SignOf(direction) > 0 ? 0 : 1] = contacts_.size();
      contacts_.push_back({.ball = static_cast<size_t>(ball),
                           .piston = static_cast<size_t>(piston),
                           .sign = SignAlongX(direction)});
    }
  }
}

void JumpCurrent::FindContact(Contact& contact) {
  Body &ball = balls_[contact.ball], &piston = pistons_[contact.piston];
  const ContactCurrents before = contact.now;
  contact.now = table_.At(ball.energy, piston.energy);
  ball.change += contact.now.ball - before.ball;
  piston.change += contact.now.piston - before.piston;
  const double more = contact.sign * (contact.now.energy - before.energy);
  current_ += more;
  current_left_ += more + contact.sign * (contact.now.products - before.products);
}

void JumpCurrent::SetTerm(double term, Body& body) {
  current_left_ += term - body.term;
  body.term = term;
}

// The ball's first direction is to the right; the opposite direction is in the middle of the list.
void JumpCurrent::FindBallTerm(size_t ball) {
  const Contact& right = contacts_[ball * directions_];
  const Contact& left = contacts_[ball * directions_ + directions_ / 2];
  const Values neighbours = pistons_[right.piston].values - pistons_[left.piston].values;
  SetTerm((neighbours * balls_[ball].change).sum(), balls_[ball]);
}

void JumpCurrent::FindPistonTerm(size_t piston) {
  const auto& [before, after] = sides_[piston];
  if (contacts_[before].sign == 0) return;
  const Values neighbours =
      balls_[contacts_[before].ball].values - balls_[contacts_[after].ball].values;
  SetTerm((neighbours * pistons_[piston].change).sum(), pistons_[piston]);
}

void JumpCurrent::Exchange(const GasEvent& exchange, double) {
  AddUntil(exchange.time);
  const auto ball = static_cast<size_t>(exchange.ball);
  const auto piston = static_cast<size_t>(exchange.piston);
  const TestFunction& f = table_.test_function();
  balls_[ball].energy = exchange.ball_energy;
  balls_[ball].values = f.OfBall(exchange.ball_energy);
  pistons_[piston].energy = exchange.piston_energy;
  pistons_[piston].values = f.OfPiston(exchange.piston_energy);
  for (size_t i = 0; i < directions_; ++i) FindContact(contacts_[ball * directions_ + i]);
  for (const size_t side : sides_[piston]) {
    if (contacts_[side].ball != ball) FindContact(contacts_[side]);
  }
  for (const size_t side : sides_[piston]) FindBallTerm(contacts_[side].ball);
  for (size_t i = 0; i < directions_; ++i) FindPistonTerm(contacts_[ball * directions_ + i].piston);
}

void JumpCurrent::AddUntil(double time) {
  steps_.AddOver(since_, time, current_);
  steps_left_.AddOver(since_, time, current_left_);
  since_ = time;
}

GreenKubo JumpCurrent::Result() const {
  const double step = steps_.length(), cells = static_cast<double>(balls_.size());
  const double unit = density_ * density_ / (4 * cells * step);  // 4: twice the currents
  const double static_value = density_ * kContactRate / 2;
  GreenKubo result;
  result.autocorrelation = LagProducts(steps_.values(), kWindow);
  result.plain = static_value - unit * IntegralsOf(result.autocorrelation).back();
  for (double& c : result.autocorrelation) c *= -unit / step;
  result.conductivity = IntegralsOf(LagProducts(steps_left_.values(), kWindow));
  for (double& k : result.conductivity) k = static_value * (1 + bound_) - unit * k;
  return result;
}

}  // namespace ballpiston
