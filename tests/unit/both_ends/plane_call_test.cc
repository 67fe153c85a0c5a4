// Pixelize: the SDK against the server itself, and against servers with arbitrary answers.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>

#include <cmath>
#include <functional>
#include <limits>
#include <thread>

#include "core/base/stop_signal.h"
#include "core/plane/pixelize.h"
#include "latvox/client.h"
#include "latvox/error.h"
#include "latvox/v1/voxelizer.grpc.pb.h"
#include "server/base/errors.h"
#include "server/listen/server.h"
#include "server/wire/plane_convert.h"
#include "server/work/pixelization.h"
#include "tests/unit/client/files.h"
#include "tests/unit/server/decoders.h"

namespace latvox {
namespace {

using client::Cancellation;
using client::Client;
using client::Pixelization;
using testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Returns a spiral and a triangle that it crosses.
std::vector<client::Polyline> Curves() {
  client::Polyline spiral;
  for (int n = 0; n < 200; ++n) spiral.points.push_back({n * std::cos(0.2 * n), n * std::sin(0.2 * n)});
  return {spiral, {{{-50, -60}, {90, 3}, {2, 77}}, true}};
}

client::PixelizeRequest Request() {
  client::PixelizeRequest request;
  request.polylines = Curves();
  request.resolution = 100;
  return request;
}

class PixelizeCall : public client::FilesTest {
 protected:
  void Start() {
    options_.listen = {"unix:" + Path("socket")};
    options_.threads = 2;
    options_.decoder = TestDecoders();
    auto server = VoxelServer::Start(options_);
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    auto connected = Client::Connect(server_->addresses()[0]);
    ASSERT_TRUE(connected.ok()) << connected.status();
    client_.emplace(*std::move(connected));
  }

  absl::StatusOr<Pixelization> Call(const client::PixelizeRequest& request) const { return client_->Pixelize(request); }

  ServerOptions options_;
  std::unique_ptr<VoxelServer> server_;
  std::optional<Client> client_;
};

TEST_F(PixelizeCall, ReturnsThePixelsOfCore) {
  Start();
  std::vector<Polyline> polylines;
  for (const client::Polyline& polyline : Curves()) polylines.push_back({polyline.points, polyline.closed});
  const PlaneLattice lattice = *PlaneLattice::FromBasis({{{1.5, 0.25}, {-0.5, 1}}});
  for (const int k : {0, 1}) {
    for (const bool minimal : {true, false}) {
      client::PixelizeRequest request;
      request.polylines = Curves();
      request.lattice = client::PlaneBasis{{1.5, 0.25}, {-0.5, 1}};
      request.origin = client::Vec2d{3, -4};
      request.separability = static_cast<uint32_t>(k);
      request.minimal = minimal;
      const auto answer = Call(request);
      ASSERT_TRUE(answer.ok()) << answer.status();
      const auto expected = *Pixelize(polylines, {lattice, {3, -4}}, {k, minimal, LineAlgorithm::kCrossing});
      EXPECT_EQ(answer->pixels, expected.pixels);
      EXPECT_EQ(answer->crossed_edges, expected.crossed_links);
      EXPECT_EQ(answer->tunnels, 0u);
      EXPECT_EQ(answer->redundant, expected.redundant);
      EXPECT_EQ(answer->redundant == 0, minimal);
      EXPECT_EQ(answer->grid.basis, std::get<client::PlaneBasis>(request.lattice));
      EXPECT_EQ(answer->grid.origin, *request.origin);
      EXPECT_EQ(answer->lattice, "basis");
      EXPECT_EQ(answer->algorithm, "exact");
      EXPECT_EQ(answer->version, LATVOX_VERSION);
      EXPECT_EQ(answer->snap_error_max, 1.0 / 512);
      EXPECT_FALSE(answer->request_id.empty());
    }
  }
}

TEST_F(PixelizeCall, EveryAlgorithmReturnsItsName) {
  Start();
  client::PixelizeRequest request = Request();
  request.lattice = client::NamedPlaneLattice::kHexagonal;
  for (const auto& [algorithm, name] : {std::pair{client::LineAlgorithm::kExact, "exact"},
                                        {client::LineAlgorithm::kBruteForce, "brute-force"},
                                        {client::LineAlgorithm::kIncremental, "incremental"},
                                        {client::LineAlgorithm::kIbanez, "ibanez"}}) {
    request.algorithm = algorithm;
    const auto answer = Call(request);
    ASSERT_TRUE(answer.ok()) << answer.status();
    EXPECT_EQ(answer->algorithm, name);
    EXPECT_EQ(answer->lattice, "hexagonal");
    EXPECT_EQ(answer->tunnels, 0u);
    EXPECT_EQ(answer->redundant, 0u);
  }
}

TEST_F(PixelizeCall, AnswersManyAtOnceAlike) {
  Start();
  const auto first = Call(Request());
  ASSERT_TRUE(first.ok()) << first.status();
  std::vector<std::thread> callers;
  callers.reserve(8);
  for (int n = 0; n < 8; ++n) {
    callers.emplace_back([&] {
      for (int again = 0; again < 20; ++again) {
        const auto answer = Call(Request());
        ASSERT_TRUE(answer.ok()) << answer.status();
        EXPECT_EQ(answer->digest, first->digest);
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
}

TEST_F(PixelizeCall, RefusalsReachTheCallerWithFieldValueAndLimit) {
  options_.limits.max_message_bytes = 1 << 15;
  Start();
  client::PixelizeRequest request = Request();
  request.polylines[0].points.resize(2000, {1, 1});
  absl::Status status = Call(request).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(status.message(), "points 2003 exceeds 1024");
  EXPECT_EQ(client::GetErrorDetails(status).field, "points");
  EXPECT_EQ(client::GetErrorDetails(status).limit, "1024");
  EXPECT_EQ(client::GetErrorDetails(status).retry_after, std::nullopt);

  request = Request();
  request.resolution = 900;
  status = Call(request).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("exceeds 3174"));
  EXPECT_EQ(client::GetErrorDetails(status).field, "pixels");

  request.resolution = 60000;
  status = Call(request).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(client::GetErrorDetails(status).field, "crossings");

  request.separability = 2;
  status = Call(request).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(client::GetErrorDetails(status).field, "separability");
}

TEST_F(PixelizeCall, CountsInTheServersMemoryBudgetAndLeavesNothingThere) {
  options_.memory_bytes = uint64_t{300} << 20;
  Start();
  EXPECT_TRUE(Call(Request()).ok());
  const absl::Time give_up = absl::Now() + absl::Seconds(20);
  while (server_->reserved_memory() > 0 && absl::Now() < give_up) absl::SleepFor(absl::Milliseconds(2));
  EXPECT_EQ(server_->reserved_memory(), 0u);
  client::PixelizeRequest large = Request();
  large.polylines.assign(1, {{}, false});
  for (int n = 0; n < 10; ++n) large.polylines[0].points.push_back({n % 2 * 1.0, n / 10.0});
  large.resolution = 60000;
  const absl::Status refused = Call(large).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(client::GetErrorDetails(refused).field, "memory");
}

TEST_F(PixelizeCall, AsManyPolylinesOfOnePointAsPointsAreAllowedFitIntoAMessage) {
  options_.limits.max_message_bytes = 1 << 15;
  Start();
  client::PixelizeRequest request;
  request.pixel_size = 1;
  request.origin = client::Vec2d{0, 0};
  for (int n = 0; n < 1024; ++n) request.polylines.push_back({{{n / 7.0, n / 3.0}}, true});
  EXPECT_TRUE(Call(request).ok()) << Call(request).status();
}

TEST_F(PixelizeCall, EndsWithTheCallersCancellationAndDeadline) {
  Start();
  client::CallOptions options;
  options.cancellation.Cancel();
  EXPECT_EQ(client_->Pixelize(Request(), options).status().code(), absl::StatusCode::kCancelled);
  client::CallOptions late;
  late.deadline = absl::Now() - absl::Seconds(1);
  EXPECT_EQ(client_->Pixelize(Request(), late).status().code(), absl::StatusCode::kDeadlineExceeded);
  // Cancellation at any moment of the computation.
  client::PixelizeRequest heavy = Request();
  heavy.resolution = 12000;
  for (int n = 0; n < 30; ++n) {
    const Cancellation cancellation;
    std::thread canceller([&, n] {
      absl::SleepFor(absl::Microseconds(200 * n));
      cancellation.Cancel();
    });
    const auto code =
        client_->Pixelize(heavy, {.deadline = std::nullopt, .cancellation = cancellation}).status().code();
    EXPECT_TRUE(code == absl::StatusCode::kCancelled || code == absl::StatusCode::kOk) << code;
    canceller.join();
  }
  const absl::Time give_up = absl::Now() + absl::Seconds(20);
  while (server_->calls() > 0 && absl::Now() < give_up) absl::SleepFor(absl::Milliseconds(2));
  EXPECT_EQ(server_->calls(), 0u);
}

TEST_F(PixelizeCall, AStoppedServerRefuses) {
  Start();
  EXPECT_TRUE(server_->Stop(absl::ZeroDuration()));
  client::CallOptions once;
  once.retry.max_retries = 0;
  EXPECT_EQ(client_->Pixelize(Request(), once).status().code(), absl::StatusCode::kUnavailable);
}

v1::PixelizeRequest GoodProto() {
  v1::PixelizeRequest request;
  v1::Polyline& polyline = *request.add_polylines();
  for (const double x : {0.0, 0.0, 10.0, 3.0}) polyline.add_xy(x);
  request.mutable_lattice()->set_named(v1::NAMED_PLANE_LATTICE_SQUARE);
  request.set_pixel_size(1);
  return request;
}

// Pixelizes with its own memory budget.
absl::StatusOr<v1::PixelizeResponse> PixelizeAlone(const v1::PixelizeRequest& request, PixelizationFacts& facts,
                                                   StopSignal stop = {}) {
  MemoryBudget budget(Limits().memory_budget_bytes);
  MemoryReservation memory(budget);
  return PixelizePolylines(request, {}, memory, stop, facts);
}

struct BadRequest {
  std::string name;
  std::function<void(v1::PixelizeRequest&)> spoil;
  std::string message, field;
};

std::vector<BadRequest> BadRequests() {
  using Proto = v1::PixelizeRequest;
  return {
      {"no polyline", [](Proto& r) { r.clear_polylines(); }, "polylines: there are none", "polylines"},
      {"empty polyline", [](Proto& r) { r.add_polylines(); }, "polyline 1 has no points", "polylines"},
      {"odd", [](Proto& r) { r.mutable_polylines(0)->add_xy(1); }, "polylines[0].xy has 5 coordinates",
       "polylines[0].xy"},
      {"infinite", [](Proto& r) { r.mutable_polylines(0)->set_xy(3, kInfinity); },
       "polylines[0].xy[3] inf is not finite", "polylines[0].xy"},
      {"no lattice", [](Proto& r) { r.clear_lattice(); }, "lattice: neither", "lattice"},
      {"unknown lattice", [](Proto& r) { r.mutable_lattice()->set_named(static_cast<v1::NamedPlaneLattice>(3)); },
       "lattice.named 3 is not a lattice", "lattice.named"},
      {"singular", [](Proto& r) { r.mutable_lattice()->mutable_basis()->mutable_a()->set_x(1); }, "", "lattice.basis"},
      {"no sampling", [](Proto& r) { r.clear_sampling(); }, "needs pixel_size or resolution", "sampling"},
      {"pixel_size", [](Proto& r) { r.set_pixel_size(-1); }, "pixel_size -1 is not", "pixel_size"},
      {"resolution 1", [](Proto& r) { r.set_resolution(1); }, "resolution 1 is below 2", "resolution"},
      {"resolution 65537", [](Proto& r) { r.set_resolution(65537); }, "resolution 65537 exceeds 65536", "resolution"},
      {"resolution of a point",
       [](Proto& r) { r.set_resolution(9), r.mutable_polylines(0)->mutable_xy()->Truncate(2); }, "single point",
       "resolution"},
      {"origin", [](Proto& r) { r.mutable_origin()->set_y(kInfinity); }, "origin.y inf is not finite", "origin.y"},
      {"separability", [](Proto& r) { r.set_separability(2); }, "separability 2 exceeds 1", "separability"},
      {"algorithm", [](Proto& r) { r.set_algorithm(static_cast<v1::LineAlgorithm>(5)); }, "algorithm 5 is not",
       "algorithm"},
      {"extent", [](Proto& r) { r.set_pixel_size(1e-7); }, "pixel_size: at 1e-07 the polylines extend over",
       "pixel_size"},
      {"no pixel size", [](Proto& r) { r.set_pixel_size(1e-300); }, "pixel_size: at 1e-300, basis: ", "pixel_size"},
      {"position", [](Proto& r) { r.mutable_origin()->set_x(1e12); }, "origin: it puts", "origin"},
  };
}

TEST(PixelizePolylines, NamesTheFieldOfEveryBadRequest) {
  PixelizationFacts facts;
  ASSERT_TRUE(PixelizeAlone(GoodProto(), facts).ok());
  EXPECT_EQ(facts.points, 2u);
  EXPECT_GT(facts.pixels, 9u);
  for (const BadRequest& bad : BadRequests()) {
    SCOPED_TRACE(bad.name);
    v1::PixelizeRequest request = GoodProto();
    bad.spoil(request);
    const absl::Status status = PixelizeAlone(request, facts).status();
    const bool exceeds = std::string(bad.name) == "extent";
    EXPECT_EQ(status.code(), exceeds ? absl::StatusCode::kResourceExhausted : absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(status.message()), HasSubstr(bad.message));
    EXPECT_EQ(CauseOf(status)->field, bad.field);
    EXPECT_EQ(CauseOf(status)->reason, exceeds ? "LIMIT_EXCEEDED" : "BAD_SPEC");
  }
}

TEST(PixelizePolylines, ChecksLongCurvesAgainstTheLimitBeforeItDigitizes) {
  v1::PixelizeRequest request = GoodProto();
  for (int n = 0; n < 1000; ++n) {
    request.mutable_polylines(0)->add_xy(n % 2 == 0 ? 0 : 60000);
    request.mutable_polylines(0)->add_xy(n % 2 == 0 ? 60000 : 1);
  }
  PixelizationFacts facts;
  const absl::Status status = PixelizeAlone(request, facts).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(CauseOf(status)->field, "crossings");
  EXPECT_LT(facts.pixelize_ms, 1000);
}

TEST(PixelizePolylines, ReservesMemoryBeforeItUsesIt) {
  v1::PixelizeRequest request = GoodProto();
  request.mutable_polylines(0)->set_xy(2, 50000);
  PixelizationFacts facts;
  MemoryBudget budget(uint64_t{1} << 30), small(uint64_t{1} << 20);
  MemoryReservation memory(budget), too_little(small);
  ASSERT_TRUE(PixelizePolylines(request, {}, memory, StopSignal(), facts).ok());
  EXPECT_GT(memory.bytes(), 50000 * sizeof(Vec2i) * 3) << "both ends of a link, and the nearer one";

  const absl::Status never = PixelizePolylines(request, {}, too_little, StopSignal(), facts).status();
  EXPECT_EQ(never.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(CauseOf(never)->field, "memory");
  EXPECT_EQ(CauseOf(never)->reason, "LIMIT_EXCEEDED");
  request.mutable_polylines(0)->mutable_xy()->Resize(20000, 1);
  EXPECT_EQ(CauseOf(PixelizePolylines(request, {}, too_little, StopSignal(), facts).status())->field, "memory")
      << "points count by themselves";

  MemoryReservation others(budget);
  memory.Shrink(0);
  ASSERT_TRUE(others.Grow(budget.total() - (1 << 10)).ok());
  const absl::Status later = PixelizePolylines(request, {}, memory, StopSignal(), facts).status();
  EXPECT_EQ(CauseOf(later)->reason, "MEMORY_IN_USE");
  EXPECT_NE(RetryDelayOf(later), std::nullopt);
}

TEST(PixelizePolylines, IsCancelledBeforeItDigitizes) {
  PixelizationFacts facts;
  StopSource stopped;
  stopped.Stop();
  EXPECT_EQ(PixelizeAlone(GoodProto(), facts, stopped.Signal()).status().code(), absl::StatusCode::kCancelled);
}

// Always answers with the response of its constructor.
class Forger final : public v1::Voxelizer::Service {
 public:
  explicit Forger(v1::PixelizeResponse response) : response_(std::move(response)) {}
  grpc::Status Pixelize(grpc::ServerContext*, const v1::PixelizeRequest*, v1::PixelizeResponse* response) override {
    *response = response_;
    return grpc::Status::OK;
  }

 private:
  const v1::PixelizeResponse response_;
};

absl::Status Forge(const v1::PixelizeResponse& response) {
  Forger forger(response);
  int port = 0;
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(&forger);
  const auto server = builder.BuildAndStart();
  const auto client = Client::Connect("127.0.0.1:" + std::to_string(port));
  EXPECT_TRUE(client.ok()) << client.status();
  return client->Pixelize({}).status();
}

TEST(Forged, EveryBreachOfTheProtocolIsDataLossAndNamed) {
  PixelizationFacts facts;
  const v1::PixelizeResponse good = *PixelizeAlone(GoodProto(), facts);
  EXPECT_TRUE(Forge(good).ok()) << Forge(good);
  const auto expect = [&](const std::function<void(v1::PixelizeResponse&)>& spoil, const std::string& says) {
    v1::PixelizeResponse response = good;
    spoil(response);
    const absl::Status status = Forge(response);
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss);
    EXPECT_THAT(std::string(status.message()), HasSubstr(says));
  };
  expect([](auto& r) { r.add_pixels(1); }, "odd number");
  expect([](auto& r) { r.mutable_pixels()->SwapElements(0, 2); }, "out of order");
  expect([](auto& r) { r.set_pixels(2, r.pixels(0)), r.set_pixels(3, r.pixels(1)); }, "out of order");
  expect([](auto& r) { r.mutable_pixels()->Truncate(r.pixels_size() - 2); }, "digest");
  expect([](auto& r) { r.clear_digest(); }, "digest");
  expect([](auto& r) { r.clear_grid(); }, "grid");
  expect([](auto& r) { r.mutable_grid()->mutable_basis()->mutable_b()->set_y(kInfinity); }, "grid");
  expect([](auto& r) { r.mutable_grid()->set_pixel_size(std::nan("")); }, "grid");
}

}  // namespace
}  // namespace latvox
