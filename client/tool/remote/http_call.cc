#include "client/tool/remote/http_call.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <pugixml.hpp>
#include <utility>

#include "absl/random/random.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "client/tool/remote/curl_library.h"
#include "client/tool/remote/remote_name.h"

namespace latvox::client {
namespace {

constexpr absl::Duration kFirstWait = absl::Milliseconds(100), kLongestWait = absl::Seconds(15);
constexpr size_t kBodyKept = size_t{1} << 16;
constexpr long kConnectSeconds = 15, kStallSeconds = 30, kMostRedirects = 5;

absl::Status CheckTime(const CallOptions& call) {
  if (call.cancellation.cancelled()) return absl::CancelledError("cancelled");
  if (call.deadline && absl::Now() >= *call.deadline) return absl::DeadlineExceededError("the --timeout passed");
  return absl::OkStatus();
}

template <class... Parts>
absl::Status Failure(absl::StatusCode code, const HttpCall& call, const Parts&... parts) {
  return {code, absl::StrCat(call.name, ": cannot be ", call.verb, " (", parts..., ")")};
}

// Handles of the library keep their connections, so that the next call need not connect again.
class Handles {
 public:
  explicit Handles(const Curl& curl) : curl_(curl) {}

  CURL* Take() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return curl_.curl_easy_init();
    CURL* const handle = idle_.back();
    idle_.pop_back();
    curl_.curl_easy_reset(handle);
    return handle;
  }

  void GiveBack(CURL* handle) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(handle);
  }

  static Handles& Of(const Curl& curl) {
    static auto& handles = *new Handles(curl);
    return handles;
  }

 private:
  const Curl& curl_;
  std::mutex mutex_;
  std::vector<CURL*> idle_;  // guarded by mutex_
};

bool IsLoopback(absl::string_view url) {
  absl::string_view host = url.substr(url.find("//") + 2);
  host = host.substr(0, host.find('/'));
  const size_t end = absl::StartsWith(host, "[") ? host.find(']') + 1 : host.find(':');
  host = host.substr(0, end);
  const auto of_number = [](char c) { return absl::ascii_isdigit(static_cast<unsigned char>(c)) || c == '.'; };
  return absl::EqualsIgnoreCase(host, "localhost") || host == "[::1]" ||
         (absl::StartsWith(host, "127.") && std::all_of(host.begin(), host.end(), of_number));
}

// One try of a call. The library calls its static functions.
class Try {
 public:
  Try(const Curl& curl, const HttpCall& call, const TransferOptions& options)
      : curl_(curl), call_(call), options_(options), handle_(Handles::Of(curl).Take()) {}
  ~Try() {
    curl_.curl_slist_free_all(headers_);
    if (handle_ != nullptr) Handles::Of(curl_).GiveBack(handle_);
  }
  Try(const Try&) = delete;
  Try& operator=(const Try&) = delete;

  // Returns the error of this side or of the network; OK if there is an answer.
  absl::Status Run() {
    if (handle_ == nullptr) return absl::ResourceExhaustedError("curl's library has no memory");
    if (call_.sink != nullptr) {
      if (auto status = call_.sink->Begin(); !status.ok()) return status;
    }
    SetUp();
    const CURLcode code = curl_.curl_easy_perform(handle_);
    if (!local_.ok()) return local_;
    if (code != CURLE_OK) return ErrorOf(code);
    long status = 0;
    curl_.curl_easy_getinfo(handle_, CURLINFO_RESPONSE_CODE, &status);
    answer_.status = static_cast<int>(status);
    return absl::OkStatus();
  }

  HttpAnswer& answer() { return answer_; }
  bool may_repeat() const { return may_repeat_; }

 private:
  template <class Value>
  void Set(CURLoption option, Value value) {
    curl_.curl_easy_setopt(handle_, option, value);
  }

  void SetUp() {
    Set(CURLOPT_URL, call_.url.c_str());
    Set(CURLOPT_NOSIGNAL, 1L);
    // curl 8 does not sign paths as they are. Keys have no part that it would take away.
    if (call_.signer == nullptr) Set(CURLOPT_PATH_AS_IS, 1L);
    Set(CURLOPT_ERRORBUFFER, error_);
    Set(CURLOPT_CONNECTTIMEOUT, kConnectSeconds);
    Set(CURLOPT_LOW_SPEED_LIMIT, 1L);
    Set(CURLOPT_LOW_SPEED_TIME, kStallSeconds);
    Set(CURLOPT_PROTOCOLS_STR, "https,http");
    Set(CURLOPT_USERAGENT, "latvox");
    if (call_.signer == nullptr && call_.method == "GET") {
      Set(CURLOPT_FOLLOWLOCATION, 1L);
      Set(CURLOPT_MAXREDIRS, kMostRedirects);
      Set(CURLOPT_REDIR_PROTOCOLS_STR, options_.allow_http ? "https,http" : "https");
    }
    Set(CURLOPT_NOPROGRESS, 0L);
    Set(CURLOPT_XFERINFOFUNCTION, &Try::OnProgress);
    Set(CURLOPT_XFERINFODATA, this);
    Set(CURLOPT_WRITEFUNCTION, &Try::OnBody);
    Set(CURLOPT_WRITEDATA, this);
    Set(CURLOPT_HEADERFUNCTION, &Try::OnHeader);
    Set(CURLOPT_HEADERDATA, this);
    SetRoots();
    SetMethod();
    for (const std::string& header : call_.headers) AddHeader(header);
    if (call_.signer != nullptr) Sign(*call_.signer);
    Set(CURLOPT_HTTPHEADER, headers_);
  }

  // The library does not read the variables by itself.
  void SetRoots() {
    for (const char* const name : {"AWS_CA_BUNDLE", "SSL_CERT_FILE"}) {
      const std::string file = ProcessVariable(name);
      if (file.empty()) continue;
      Set(CURLOPT_CAINFO, file.c_str());
      return;
    }
  }

  void SetMethod() {
    if (call_.method == "HEAD") Set(CURLOPT_NOBODY, 1L);
    if (call_.method == "DELETE") Set(CURLOPT_CUSTOMREQUEST, "DELETE");
    if (call_.method == "POST") {
      Set(CURLOPT_POST, 1L);
      Set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(call_.body->text.size()));
      Set(CURLOPT_POSTFIELDS, call_.body->text.c_str());
    }
    if (call_.method == "PUT") {
      Set(CURLOPT_UPLOAD, 1L);
      Set(CURLOPT_INFILESIZE_LARGE, static_cast<curl_off_t>(call_.body->bytes));
      Set(CURLOPT_READFUNCTION, &Try::OnRead);
      Set(CURLOPT_READDATA, this);
      Set(CURLOPT_SEEKFUNCTION, &Try::OnSeek);
      Set(CURLOPT_SEEKDATA, this);
    }
  }

  void Sign(const AwsSettings& signer) {
    Set(CURLOPT_AWS_SIGV4, absl::StrCat("aws:amz:", signer.region, ":s3").c_str());
    Set(CURLOPT_USERNAME, signer.key_id.c_str());
    Set(CURLOPT_PASSWORD, signer.secret.c_str());
    if (!signer.session_token.empty()) AddHeader("x-amz-security-token: " + signer.session_token);
  }

  void AddHeader(const std::string& header) { headers_ = curl_.curl_slist_append(headers_, header.c_str()); }

  static int OnProgress(void* self, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
    auto& that = *static_cast<Try*>(self);
    if (auto status = CheckTime(that.options_.call); !status.ok()) that.local_ = status;
    return that.local_.ok() ? 0 : 1;
  }

  static size_t OnHeader(char* bytes, size_t, size_t count, void* self) {
    auto& headers = static_cast<Try*>(self)->answer_.headers;
    const absl::string_view line(bytes, count);
    if (absl::StartsWith(line, "HTTP/")) headers.clear();  // of a redirection, or of 100 Continue
    if (const size_t colon = line.find(':'); colon != absl::string_view::npos) {
      headers[absl::AsciiStrToLower(line.substr(0, colon))] =
          std::string(absl::StripAsciiWhitespace(line.substr(colon + 1)));
    }
    return count;
  }

  static size_t OnBody(char* bytes, size_t, size_t count, void* self) {
    auto& that = *static_cast<Try*>(self);
    long status = 0;
    that.curl_.curl_easy_getinfo(that.handle_, CURLINFO_RESPONSE_CODE, &status);
    if (that.call_.sink != nullptr && status / 100 == 2) {
      that.local_ = that.call_.sink->Add({bytes, count});
      return that.local_.ok() ? count : 0;
    }
    that.answer_.body.append(bytes, std::min(count, kBodyKept - std::min(kBodyKept, that.answer_.body.size())));
    return count;
  }

  static size_t OnRead(char* bytes, size_t, size_t count, void* self) {
    auto& that = *static_cast<Try*>(self);
    const HttpBody& body = *that.call_.body;
    const size_t wanted = std::min<uint64_t>(count, body.bytes - that.sent_);
    ssize_t n = 0;
    do {
      n = wanted == 0 ? 0 : pread(body.fd, bytes, wanted, static_cast<off_t>(body.offset + that.sent_));
    } while (n < 0 && errno == EINTR);
    if (n < 0 || (n == 0 && wanted > 0)) {
      that.local_ = Failure(absl::StatusCode::kFailedPrecondition, that.call_,
                            "its local copy cannot be read: ", n < 0 ? std::strerror(errno) : "it has become shorter");
      return CURL_READFUNC_ABORT;
    }
    that.sent_ += static_cast<uint64_t>(n);
    return static_cast<size_t>(n);
  }

  static int OnSeek(void* self, curl_off_t offset, int) {
    static_cast<Try*>(self)->sent_ = static_cast<uint64_t>(offset);
    return CURL_SEEKFUNC_OK;
  }

  absl::Status ErrorOf(CURLcode code) {
    may_repeat_ = code != CURLE_PEER_FAILED_VERIFICATION && code != CURLE_SSL_CACERT_BADFILE &&
                  code != CURLE_UNSUPPORTED_PROTOCOL && code != CURLE_URL_MALFORMAT &&
                  code != CURLE_TOO_MANY_REDIRECTS && code != CURLE_OUT_OF_MEMORY;
    const std::string what = Redact(error_[0] != 0 ? error_ : curl_.curl_easy_strerror(code));
    return Failure(absl::StatusCode::kUnavailable, call_, absl::StripAsciiWhitespace(what));
  }

  const Curl& curl_;
  const HttpCall& call_;
  const TransferOptions& options_;
  CURL* const handle_;
  curl_slist* headers_ = nullptr;
  char error_[CURL_ERROR_SIZE] = "";
  HttpAnswer answer_;
  absl::Status local_;  // an error of this side
  uint64_t sent_ = 0;   // bytes of the body
  bool may_repeat_ = false;
};

// Returns the text of an element of S3's errors, or "".
std::string ElementOf(const std::string& body, const char* name) {
  pugi::xml_document document;
  if (!document.load_buffer(body.data(), body.size())) return "";
  return document.child("Error").child_value(name);
}

// Returns whether the other side may give another answer soon. Damaged bodies count: the next one may arrive whole.
bool IsPassing(const HttpAnswer& answer) {
  constexpr int kPassing[] = {408, 409, 425, 429, 500, 502, 503, 504};
  if (std::find(std::begin(kPassing), std::end(kPassing), answer.status) != std::end(kPassing)) return true;
  if (answer.status != 400) return false;
  const std::string code = ElementOf(answer.body, "Code");
  return code == "RequestTimeout" || code == "BadDigest" || code == "IncompleteBody" ||
         code == "XAmzContentSHA256Mismatch";
}

// Waits before the next try, as long as the answer asks for, or twice as long each time.
absl::Status Wait(int tries, const HttpAnswer& answer, const TransferOptions& options) {
  static thread_local absl::BitGen random;
  const absl::Duration most = std::min(kFirstWait * std::exp2(tries), kLongestWait);
  absl::Duration wait = most * absl::Uniform(random, 0.5, 1.0);
  int seconds = 0;
  if (absl::SimpleAtoi(answer.Header("retry-after"), &seconds) && seconds > 0) {
    wait = std::min(absl::Seconds(seconds), 4 * kLongestWait);
  }
  absl::Notification cancelled;
  const Cancellation::Subscription on_cancel(options.call.cancellation, [&cancelled] { cancelled.Notify(); });
  const absl::Time end = std::min(absl::Now() + wait, options.call.deadline.value_or(absl::InfiniteFuture()));
  cancelled.WaitForNotificationWithDeadline(end);
  return CheckTime(options.call);
}

// Returns what is wrong with an answer; OK if the call has it. `again` tells whether to ask again.
absl::Status Judge(const HttpCall& call, const HttpAnswer& answer, bool& again) {
  again = IsPassing(answer);
  if (std::find(call.expected.begin(), call.expected.end(), answer.status) != call.expected.end()) {
    return absl::OkStatus();
  }
  if (answer.status / 100 != 2) return RefusalOf(call, answer);
  absl::Status checked = call.check ? call.check(answer) : absl::OkStatus();
  again = !checked.ok();
  return checked;
}

absl::Status TriedEnough(const absl::Status& status, int tries) {
  const std::string count = tries == 1 ? "" : absl::StrCat("; ", tries, " tries failed");
  return {status.code(), absl::StrCat(status.message(), count)};
}

}  // namespace

std::string HttpAnswer::Header(const std::string& name) const {
  const auto found = headers.find(name);
  return found == headers.end() ? "" : found->second;
}

absl::Status RefusalOf(const HttpCall& call, const HttpAnswer& answer) {
  using Code = absl::StatusCode;
  const int status = answer.status;
  const Code code = status == 404 || status == 410   ? Code::kNotFound
                    : status == 401 || status == 403 ? Code::kUnauthenticated
                    : IsPassing(answer)              ? Code::kUnavailable
                                                     : Code::kFailedPrecondition;
  const std::string reason = ElementOf(answer.body, "Code"), message = ElementOf(answer.body, "Message");
  const std::string region = answer.Header("x-amz-bucket-region");
  const bool elsewhere = status == 301 || status == 307 || status == 400;
  return Failure(code, call, "HTTP ", status, reason.empty() ? "" : " ", reason, message.empty() ? "" : ": ",
                 Redact(message), elsewhere && !region.empty() ? "; the bucket's AWS_REGION is " + region : "");
}

absl::Status CheckScheme(const HttpCall& call, const TransferOptions& options) {
  const bool plain = absl::StartsWithIgnoreCase(call.url, "http:");
  if (!plain || options.allow_http || IsLoopback(call.url)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(call.name, ": http: to another machine needs --allow-http, because others can read and change it"));
}

absl::StatusOr<HttpAnswer> Call(const HttpCall& call, const TransferOptions& options) {
  if (auto status = CheckScheme(call, options); !status.ok()) return status;
  const auto curl = Curl::Load();
  if (!curl.ok()) return curl.status();
  for (int tries = 1;; ++tries) {
    if (auto status = CheckTime(options.call); !status.ok()) return status;
    Try one(**curl, call, options);
    absl::Status status = one.Run();
    bool again = one.may_repeat();
    if (status.ok()) status = Judge(call, one.answer(), again);
    if (status.ok()) {
      one.answer().tries = tries;
      return std::move(one.answer());
    }
    if (!again) return status;
    if (tries == options.tries) return TriedEnough(status, tries);
    if (auto waited = Wait(tries, one.answer(), options); !waited.ok()) return waited;
  }
}

}  // namespace latvox::client
