#include "server/guard/connections.h"

#include <utility>

#include "absl/time/clock.h"
#include "server/base/log.h"

namespace latvox {
namespace {

// What gRPC needs for a new connection, and what OpenSSL needs for a handshake.
constexpr Work kAcceptWork = 200'000, kHandshakeWork = 1'500'000;

// A connection may cause the work of so long at once.
constexpr Work kBurstsInASecond = 5;

// The host of the descriptor that this thread read last. gRPC decrypts on the thread that has read, before it reads
// again. If it did not, work would count for another host.
thread_local std::shared_ptr<HostBudget> last_host;

}  // namespace

GuardedStream::GuardedStream(const GuardLimits& limits, std::shared_ptr<HostBudget> host, absl::Time now)
    : budget_(limits.work_per_connection, limits.work_per_connection / kBurstsInASecond, now), host_(std::move(host)) {}

std::optional<Offense> GuardedStream::Receive(absl::string_view bytes) {
  if (offense_) return offense_;
  FrameWork work;
  offense_ = frames_.Receive(bytes, work);
  if (offense_ || work.all == 0) return offense_;
  const absl::Time now = absl::Now();
  if (!budget_.Spend(work.unasked, now)) offense_ = Offense::kFlood;
  if (host_ && !host_->SpendOnFrames(work.all, now)) offense_ = Offense::kHost;
  return offense_;
}

GuardedConnection::GuardedConnection(const GuardLimits& limits, std::shared_ptr<HostBudget> host,
                                     const sockaddr_storage& peer, absl::Time now)
    : stream_(limits, host, now), host_(std::move(host)), peer_(peer) {}

std::optional<Offense> GuardedConnection::Receive(absl::string_view bytes) {
  if (bytes.empty()) return std::nullopt;
  if (kind_ == Kind::kUnknown) {
    kind_ = bytes.front() == 'P' ? Kind::kPlain : Kind::kTls;
    if (kind_ == Kind::kTls && host_ && !host_->SpendOnArrival(kHandshakeWork, absl::Now())) return Offense::kHost;
  }
  return kind_ == Kind::kPlain ? stream_.Receive(bytes) : std::nullopt;
}

Connections::Connections(const GuardLimits& limits)
    : limits_(limits), hosts_(limits.work_per_host), slots_(2 * limits.connections) {}

Connections::~Connections() {
  for (const auto& slot : slots_) delete slot.load();
}

std::optional<Offense> Connections::Add(int fd, const sockaddr_storage& address) {
  const absl::Time now = absl::Now();
  const std::string key = HostKey(address);
  auto host = key.empty() ? nullptr : hosts_.Of(key, now);
  if (static_cast<size_t>(fd) >= slots_.size() || count_ >= limits_.connections) return Offense::kHost;
  if (host && !host->SpendOnArrival(kAcceptWork, now)) return Offense::kHost;
  // Each connection holds its host twice, with TLS three times.
  if (host && static_cast<size_t>(host.use_count()) > 2 * limits_.connections_per_host) return Offense::kHost;
  const GuardedConnection* const before =
      slots_[fd].exchange(new GuardedConnection(limits_, std::move(host), address, now));
  if (before == nullptr) ++count_;
  delete before;
  return std::nullopt;
}

void Connections::Remove(int fd) {
  if (fd < 0 || static_cast<size_t>(fd) >= slots_.size()) return;
  if (slots_[fd].load(std::memory_order_relaxed) == nullptr) return;
  if (const GuardedConnection* const connection = slots_[fd].exchange(nullptr)) {
    delete connection;
    --count_;
  }
}

std::optional<sockaddr_storage> Connections::PeerOf(int fd) const {
  if (fd < 0 || static_cast<size_t>(fd) >= slots_.size()) return std::nullopt;
  const GuardedConnection* const connection = slots_[fd].load();
  return connection == nullptr ? std::nullopt : std::optional(connection->peer());
}

std::optional<Offense> Connections::Receive(int fd, absl::string_view bytes) {
  if (fd < 0 || static_cast<size_t>(fd) >= slots_.size()) return std::nullopt;
  GuardedConnection* const connection = slots_[fd].load();
  if (connection == nullptr) return std::nullopt;
  if (last_host != connection->host()) last_host = connection->host();
  return connection->Receive(bytes);
}

std::unique_ptr<GuardedStream> Connections::NewTlsStream() const {
  return std::make_unique<GuardedStream>(limits_, last_host, absl::Now());
}

void Connections::Count(Offense offense) {
  const uint64_t before = closed_[static_cast<size_t>(offense)]++;
  const int64_t now = absl::ToUnixSeconds(absl::Now());
  int64_t last = logged_.load();
  if (last == now || !logged_.compare_exchange_strong(last, now)) return;  // a flood must not fill the log
  Log(LogLevel::kWarning, "connection_closed", {{"offense", ToWord(offense)}, {"of_this_kind", before + 1}});
}

GuardFacts Connections::facts() const {
  GuardFacts facts;
  for (size_t n = 0; n < closed_.size(); ++n) facts.closed[n] = closed_[n];
  facts.connections = count_;
  return facts;
}

}  // namespace latvox
