#include "core/gpu/device_orbits.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/billiard/lane_constants.h"
#include "core/billiard/lane_orbit.h"

namespace ballpiston {
namespace {

// Flights of a lane in a launch, at most: some milliseconds.
constexpr size_t kMostFlightsInALaunch = 2048;

// The most calls of the source's Next between two calls of Pause.
constexpr size_t kStartsBetweenLooks = 8192;

// Rounding of a path must not end an orbit that its collision would end in time.
constexpr double kRoundingOfAPath = 1e-9;

uint32_t SignBit(double sign) { return sign < 0 ? kSign : 0; }
double SignOf(uint32_t bits) { return IsSet(bits) ? -1 : 1; }

LaneFrame FrameOf(const FlightBall& ball) {
  return {ball.h, ball.e, ball.c, ball.s, SignOf(ball.a), SignOf(ball.a ^ ball.ab), SignOf(ball.m)};
}

// The rest of the burst of a report that was a false alarm: `report` is of what happens next, if
// this is in the same burst.
bool EndsBurst(const FlightProgram& program, FlightReport& report) {
  FlightLane& lane = report.lane;
  Fly(program, lane.ball);
  lane.in_reach = InReach(program, lane.ball);
  report.news = FlyBurst(program, lane, report.flight + 1, report.flight, report.path_after);
  return report.news == FlightNews::kNone;
}

// If the device fails, the run goes on in the lanes and is their source: it supplies first the
// orbits in progress, then those of its own source.
class DeviceRun : public EngineRun, private OrbitSource {
 public:
  DeviceRun(const PairGeometry& geometry, OrbitSource& source, std::unique_ptr<FlightBatch> batch,
            std::function<void(const absl::Status&)> fail)
      : geometry_(geometry),
        source_(source),
        fail_(std::move(fail)),
        batch_(std::move(batch)),
        program_(ProgramOf(geometry)),
        scale_(FlightConstants<double>(geometry).scale),
        in_lane_(geometry, scale_, source.TimeLimit()) {}

  bool Advance() override {
    if (lanes_ != nullptr) return lanes_->Advance();
    do {
      source_is_empty_ = false;
      if (is_flying_ && !Land()) return lanes_->Advance();
      StartNew();
      if (in_progress_ == 0 && source_is_empty_) return true;
      if (in_progress_ > 0 && !Launch()) return lanes_->Advance();
    } while (!source_.Pause());
    return false;
  }

 private:
  struct OrbitInProgress {
    LaneOrbit orbit;
    OrbitStart start = {};  // or its last collision, after the exchange
    bool is_in_progress = false;
  };

  // ---- the device ----

  bool Launch() {
    const absl::Status launched = batch_->Launch(queue_, bursts_);
    if (!launched.ok()) return GoOnInLanes(launched);
    is_flying_ = true;
    return true;
  }

  bool Land() {
    is_flying_ = false;
    const absl::StatusOr<FlightBatch::Landing> landing = batch_->Land();
    if (!landing.ok()) return GoOnInLanes(landing.status());
    queue_.erase(queue_.begin(), queue_.begin() + static_cast<ptrdiff_t>(landing->taken));
    const size_t ended = landing->reports.size();
    lanes_with_orbits_ += landing->taken;
    lanes_with_orbits_ -= ended;
    for (const FlightReport& report : landing->reports) Take(report);
    SetSizes(ended);
    return true;
  }

  // Orbits that end in a launch leave their lanes idle if too few others wait.
  void SetSizes(size_t ended) {
    const size_t lanes = batch_->lanes();
    const auto most = static_cast<uint32_t>(kMostFlightsInALaunch / program_.flights);
    if (ended > lanes / 4) bursts_ = std::max(bursts_ / 2, uint32_t{1});
    if (ended < lanes / 8) bursts_ = std::min(bursts_ * 2, most);
    reserve_ = std::min(ended + ended / 2 + 64, lanes);
  }

  // Always false.
  bool GoOnInLanes(const absl::Status& status) {
    fail_(status);
    for (const OrbitInProgress& orbit : orbits_) {
      if (orbit.is_in_progress) restarts_.push_back(orbit.start);
    }
    batch_.reset();
    lanes_ = StartLaneOrbits(geometry_, *this);
    return false;
  }

  std::optional<OrbitStart> Next() override {
    if (restarts_.empty()) return source_.Next();
    const OrbitStart start = restarts_.back();
    restarts_.pop_back();
    return start;
  }
  AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
    return source_.Collide(orbit, collision);
  }
  double TimeLimit() const override { return source_.TimeLimit(); }
  bool Pause() override { return source_.Pause(); }

  // ---- reports ----

  void Take(FlightReport report) {
    while (!TryTake(report)) {
      if (!EndsBurst(program_, report)) continue;
      queue_.push_back(report.lane);
      return;
    }
  }

  // False after a false alarm.
  bool TryTake(const FlightReport& report) {
    const FlightLane& lane = report.lane;
    const LaneOrbit& orbit = orbits_[lane.orbit].orbit;
    if (report.news == FlightNews::kEscaped) return Report(lane.orbit, OrbitInLane::Escape());
    if (report.news == FlightNews::kOverdue) {
      return Report(lane.orbit, in_lane_.Overdue(in_lane_.TimeOf(orbit, lane.path_before)));
    }
    const double phase = PhaseAfter(lane, lane.ball.path);
    const std::optional<OrbitInLane::Meeting> met =
        in_lane_.Meet(orbit, {.ball = FrameOf(lane.ball),
                              .phase = phase - std::floor(phase),
                              .path = lane.path_before + lane.ball.path,
                              .length = report.path_after - lane.ball.path,
                              .flights = lane.bursts * program_.flights + report.flight});
    return met && Report(lane.orbit, met->collision);
  }

  // Always true.
  bool Report(uint32_t number, const Collision& collision) {
    OrbitInProgress& reported = orbits_[number];
    const uint64_t orbit = reported.orbit.orbit;
    const AfterCollision after = source_.Collide(orbit, collision);
    if (after == AfterCollision::kEnd || collision.escaped || collision.expired) {
      reported.is_in_progress = false;
      free_.push_back(number);
      --in_progress_;
    } else {
      Enter(number, {orbit, AfterExchange(collision.state, 1.0)});
    }
    return true;
  }

  // ---- starts ----

  void StartNew() {
    const size_t wanted = batch_->lanes() - lanes_with_orbits_ + reserve_;
    for (size_t i = 0; i < kStartsBetweenLooks && queue_.size() < wanted; ++i) {
      const std::optional<OrbitStart> start = source_.Next();
      source_is_empty_ = !start;
      if (!start) return;
      StartOne(*start);
    }
  }

  void StartOne(const OrbitStart& start) {
    if (!InsideCell(geometry_, start.state.position, kOnAWallAtStart)) {
      source_.Collide(start.orbit, OrbitInLane::Escape());
      return;
    }
    const uint32_t number = NewNumber();
    orbits_[number].is_in_progress = true;
    ++in_progress_;
    Enter(number, start);
  }

  uint32_t NewNumber() {
    if (free_.empty()) {
      free_.push_back(static_cast<uint32_t>(orbits_.size()));
      orbits_.emplace_back();
    }
    const uint32_t number = free_.back();
    free_.pop_back();
    return number;
  }

  // A ball at rest collides, or is lost, at once. After the exchange it has the piston's speed, so
  // Enter calls itself only once more.
  void Enter(uint32_t number, const OrbitStart& start) {
    OrbitInProgress& entered = orbits_[number];
    entered.start = start;
    entered.orbit = in_lane_.Orbit(start);
    if (const std::optional<Collision> met = in_lane_.MeetAtRest(entered.orbit, start.state)) {
      Report(number, *met);
      return;
    }
    const LaneOrbit& orbit = entered.orbit;
    const LaneEntry entry = in_lane_.Enter(orbit, start.state, kSlack<double>);
    queue_.push_back(
        {.ball = BallOf(entry.ball),
         .phase = entry.phase,
         .ratio = entry.ratio,
         .path_before = 0,
         .longest_path = orbit.longest_wait * orbit.ball_speed * scale_ * (1 + kRoundingOfAPath),
         .bursts = 0,
         .in_reach = entry.in_reach ? kSign : 0,
         .orbit = number});
  }

  PairGeometry geometry_;
  OrbitSource& source_;
  const std::function<void(const absl::Status&)> fail_;
  std::unique_ptr<FlightBatch> batch_;
  FlightProgram program_;
  double scale_;
  OrbitInLane in_lane_;
  bool is_flying_ = false;
  uint32_t bursts_ = 8;                  // of a launch
  size_t lanes_with_orbits_ = 0;         // after the last landing
  size_t reserve_ = 64;                  // orbits that wait for a lane
  std::vector<FlightLane> queue_;        // the orbits that have no lane yet
  std::vector<OrbitInProgress> orbits_;  // by number
  std::vector<uint32_t> free_;           // numbers
  size_t in_progress_ = 0;
  bool source_is_empty_ = false;
  // After a failure of the device.
  std::vector<OrbitStart> restarts_;
  std::unique_ptr<EngineRun> lanes_;
};

}  // namespace

FlightBall BallOf(const LaneFrame& frame) {
  return {.h = frame.h,
          .e = frame.e,
          .c = frame.c,
          .s = frame.s,
          .path = 0,
          .a = SignBit(frame.a),
          .ab = SignBit(frame.a * frame.b),
          .m = SignBit(frame.m)};
}

FlightProgram ProgramOf(const PairGeometry& geometry) {
  const FlightConstants<double> flight(geometry);
  const ReachConstants<double> reach(geometry, flight.scale);
  const size_t flights = FlightsInABurst(geometry);
  return {.sqrt_2 = flight.sqrt_2,
          .half_height = flight.half_height,
          .length_squared = flight.length_squared,
          .tip = flight.tip,
          .left = reach.left,
          .period = reach.period,
          .phase_at_tip = reach.phase_at_tip,
          .edge = reach.edge,
          .missed_by_rounding = kMissedByRounding<double>,
          .flights = static_cast<uint32_t>(flights),
          .looks_first = flights == kMostFlights};
}

// With twice as many lanes as keep the device busy, half of the runs can be busy with their
// sources.
OrbitsOnDevice::OrbitsOnDevice(std::unique_ptr<FlightDevice> device, size_t runs,
                               std::function<void(const absl::Status&)> on_failure)
    : device_(std::move(device)),
      runs_(runs),
      lanes_(std::clamp<size_t>(2 * device_->lanes() / runs, 1, device_->lanes())),
      on_failure_(std::move(on_failure)) {}

std::unique_ptr<EngineRun> OrbitsOnDevice::Start(const PairGeometry& geometry,
                                                 OrbitSource& source) {
  if (has_failed_) return nullptr;
  absl::StatusOr<std::unique_ptr<FlightBatch>> batch =
      device_->MakeBatch(ProgramOf(geometry), lanes_);
  if (!batch.ok()) {
    Fail(batch.status());
    return nullptr;
  }
  return std::make_unique<DeviceRun>(geometry, source, *std::move(batch),
                                     [this](const absl::Status& status) { Fail(status); });
}

void OrbitsOnDevice::Fail(const absl::Status& status) {
  if (!has_failed_.exchange(true)) on_failure_(status);
}

}  // namespace ballpiston
