// One HTTP call: tried again if the network or the other side fails for a while.
#ifndef LATVOX_CLIENT_TOOL_REMOTE_HTTP_CALL_H_
#define LATVOX_CLIENT_TOOL_REMOTE_HTTP_CALL_H_

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/tool/remote/aws_settings.h"
#include "latvox/call_options.h"

namespace latvox::client {

struct TransferOptions {
  CallOptions call = {};  // its retries are those of servers of voxels: they do not count here
  int tries = kStandardTries;
  bool allow_http = false;  // to other machines; this machine's own loopback addresses are always allowed
};

// Where the body of a call comes from: a part of an open file, or else a text.
struct HttpBody {
  int fd = -1;
  uint64_t offset = 0, bytes = 0;
  std::string text = {};
};

// Receives the body of a good answer. One of the two functions is called for each try.
class HttpSink {
 public:
  virtual ~HttpSink() = default;
  virtual absl::Status Begin() = 0;  // forgets the bytes of an earlier try
  virtual absl::Status Add(std::string_view bytes) = 0;
};

struct HttpAnswer {
  int status = 0;
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;                            // without a sink; of a refusal, its first 64 KiB
  int tries = 1;

  // Returns the value, or "".
  std::string Header(const std::string& name) const;
};

struct HttpCall {
  std::string name;  // of the object, for errors
  std::string verb;  // "read" or "written", for errors
  std::string method = "GET", url;
  std::vector<std::string> headers = {};
  const AwsSettings* signer = nullptr;  // null: without a signature
  const HttpBody* body = nullptr;       // of PUT and POST
  HttpSink* sink = nullptr;
  // Checks a good answer. An error is a reason to try again.
  std::function<absl::Status(const HttpAnswer&)> check = nullptr;
  std::vector<int> expected = {};  // statuses of refusals that are an answer, not an error
};

// Tries as often as the options say: eight times take half a minute, or as long as the other side asks for. Memory:
// some buffers. Errors, all with the name, and none with a query, a header or a credential:
//   CANCELLED, DEADLINE_EXCEEDED   by the options
//   INVALID_ARGUMENT               http: to another machine
//   NOT_FOUND                      404, 410
//   UNAUTHENTICATED                401, 403
//   UNAVAILABLE                    all tries failed, or the certificate of the other side is wrong
//   FAILED_PRECONDITION            other refusals; no library of curl; a file cannot be read or written
absl::StatusOr<HttpAnswer> Call(const HttpCall& call, const TransferOptions& options);

// Returns INVALID_ARGUMENT for http: to another machine that is not allowed.
absl::Status CheckScheme(const HttpCall& call, const TransferOptions& options);

// Returns the status of a refusal.
absl::Status RefusalOf(const HttpCall& call, const HttpAnswer& answer);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_REMOTE_HTTP_CALL_H_
