#include "client/tool/remote/object_transfer.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <pugixml.hpp>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "client/tool/remote/checksum.h"

namespace latvox::client {
namespace {

constexpr char kRead[] = "read", kWritten[] = "written", kNotePrefix[] = "x-amz-meta-";
constexpr uint64_t kMostParts = 10000, kMostPartBytes = uint64_t{5} << 30;

// The settings of S3, read once: they do not change within a process.
const absl::StatusOr<AwsSettings>& Settings() {
  static const auto* const kSettings = new absl::StatusOr<AwsSettings>(ReadAwsSettings(ProcessVariable));
  return *kSettings;
}

// Buckets of another endpoint are folders of it. AWS's own have names below its own, and its certificates fit only
// names without dots.
std::string UrlOf(const RemoteName& remote, const AwsSettings& settings) {
  const std::string key = Escape(remote.key, /*keep_slash=*/true);
  if (!settings.endpoint.empty()) return absl::StrCat(settings.endpoint, "/", remote.bucket, "/", key);
  const std::string suffix = absl::StartsWith(settings.region, "cn-") ? ".amazonaws.com.cn" : ".amazonaws.com";
  const std::string host = absl::StrCat("s3.", settings.region, suffix);
  if (absl::StrContains(remote.bucket, '.')) return absl::StrCat("https://", host, "/", remote.bucket, "/", key);
  return absl::StrCat("https://", remote.bucket, ".", host, "/", key);
}

// Returns a call of the object.
absl::StatusOr<HttpCall> CallOf(const RemoteName& remote, const char* method, const char* verb,
                                const std::string& query = "") {
  HttpCall call{.name = remote.name, .verb = verb, .method = method, .url = remote.url};
  if (!remote.is_s3()) return call;
  const auto& settings = Settings();
  if (!settings.ok()) {
    return absl::Status(settings.status().code(), absl::StrCat(remote.name, ": ", settings.status().message()));
  }
  call.url = UrlOf(remote, *settings);
  if (!query.empty()) absl::StrAppend(&call.url, "?", query);
  call.signer = &*settings;
  return call;
}

// S3 refuses a body that has another SHA-256 or MD5.
void AddChecksums(const Checksums& sums, HttpCall& call) {
  if (!sums.md5.empty()) call.headers.push_back("Content-MD5: " + absl::Base64Escape(sums.md5));
  if (call.signer == nullptr) return;
  const std::string hex = absl::BytesToHexString(sums.sha256);
  call.headers.push_back("x-amz-content-sha256: " + (sums.sha256.empty() ? "UNSIGNED-PAYLOAD" : hex));
}

// Returns the ETag if it is the object's MD5, in hexadecimal digits; otherwise "". The ETag is no MD5 for an object in
// parts, for one encrypted with other keys than those of S3, and on other servers than S3.
std::string Md5Of(const HttpAnswer& answer) {
  const std::string etag = absl::StrReplaceAll(answer.Header("etag"), {{"\"", ""}});
  const std::string encryption = answer.Header("x-amz-server-side-encryption");
  const auto is_digit = [](char c) { return absl::ascii_isxdigit(static_cast<unsigned char>(c)); };
  const bool is_md5 = etag.size() == 32 && std::all_of(etag.begin(), etag.end(), is_digit);
  const bool is_plain = (encryption.empty() || encryption == "AES256") &&
                        answer.Header("x-amz-server-side-encryption-customer-algorithm").empty();
  return is_md5 && is_plain && !answer.Header("x-amz-request-id").empty() ? absl::AsciiStrToLower(etag) : "";
}

// Returns an error if the checksums that an answer states are not these.
absl::Status Compare(const std::string& name, const HttpAnswer& answer, const Checksums& sums) {
  const auto differs = [&](const char* kind) {
    return absl::UnavailableError(absl::StrCat(name, ": was damaged on its way (another ", kind, ")"));
  };
  const std::string sha256 = answer.Header("x-amz-checksum-sha256");
  const bool of_parts = absl::StrContains(sha256, '-') || answer.Header("x-amz-checksum-type") == "COMPOSITE";
  if (!sha256.empty() && !of_parts && !sums.sha256.empty() && sha256 != absl::Base64Escape(sums.sha256)) {
    return differs("SHA-256");
  }
  const std::string md5 = Md5Of(answer);
  if (!md5.empty() && !sums.md5.empty() && md5 != absl::BytesToHexString(sums.md5)) return differs("MD5");
  return absl::OkStatus();
}

// Writes a body to a file.
class FileSink : public HttpSink {
 public:
  FileSink(std::string name, std::string path)
      : name_(std::move(name)), fd_(open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0600)) {}
  ~FileSink() override {
    if (fd_ >= 0) close(fd_);
  }
  FileSink(const FileSink&) = delete;
  FileSink& operator=(const FileSink&) = delete;

  absl::Status Begin() override {
    checksum_ = Checksum();
    bytes_ = 0;
    return fd_ >= 0 && lseek(fd_, 0, SEEK_SET) == 0 && ftruncate(fd_, 0) == 0 ? absl::OkStatus() : Error();
  }

  absl::Status Add(std::string_view bytes) override {
    checksum_.Add(bytes);
    bytes_ += bytes.size();
    while (!bytes.empty()) {
      const ssize_t n = write(fd_, bytes.data(), bytes.size());
      if (n < 0 && errno != EINTR) return Error();
      if (n > 0) bytes.remove_prefix(static_cast<size_t>(n));
    }
    return absl::OkStatus();
  }

  absl::Status Check(const HttpAnswer& answer) {
    uint64_t length = 0;
    if (absl::SimpleAtoi(answer.Header("content-length"), &length) && length != bytes_) {
      return absl::UnavailableError(absl::StrCat(name_, ": has ", length, " bytes, but ", bytes_, " arrived"));
    }
    return Compare(name_, answer, checksum_.Finish());
  }

 private:
  absl::Status Error() const {
    return absl::FailedPreconditionError(
        absl::StrCat(name_, ": its local copy cannot be written (", std::strerror(errno), ")"));
  }

  const std::string name_;
  const int fd_;
  Checksum checksum_;
  uint64_t bytes_ = 0;
};

}  // namespace

absl::Status CheckAccess(const RemoteName& remote, const TransferOptions& options) {
  const auto call = CallOf(remote, "GET", kRead);
  return call.ok() ? CheckScheme(*call, options) : call.status();
}

absl::Status Fetch(const RemoteName& remote, const std::string& path, const TransferOptions& options) {
  auto call = CallOf(remote, "GET", kRead);
  if (!call.ok()) return call.status();
  FileSink sink(remote.name, path);
  call->sink = &sink;
  call->check = [&sink](const HttpAnswer& answer) { return sink.Check(answer); };
  if (remote.is_s3()) {
    call->headers = {"x-amz-checksum-mode: ENABLED"};
    AddChecksums(ChecksumsOf(""), *call);
  }
  return Call(*call, options).status();
}

absl::StatusOr<std::optional<ObjectFacts>> FactsOf(const RemoteName& remote, const TransferOptions& options) {
  auto call = CallOf(remote, "HEAD", kRead);
  if (!call.ok()) return call.status();
  call->expected = {403, 404, 410};
  if (remote.is_s3()) {
    AddChecksums(ChecksumsOf(""), *call);
  } else {
    call->expected.insert(call->expected.end(), {400, 401, 405, 501});
  }
  const auto answer = Call(*call, options);
  if (!answer.ok()) return answer.status();
  if (answer->status == 404 || answer->status == 410) return std::nullopt;
  ObjectFacts facts;
  if (answer->status / 100 != 2) return facts;
  if (!absl::SimpleAtoi(answer->Header("content-length"), &facts.bytes)) facts.bytes = 0;
  for (const auto& [header, value] : answer->headers) {
    if (absl::StartsWith(header, kNotePrefix)) facts.notes[header.substr(std::strlen(kNotePrefix))] = value;
  }
  return facts;
}

Upload::Upload(RemoteName remote, const TransferOptions& options, ObjectNotes notes)
    : remote_(std::move(remote)), options_(options), notes_(std::move(notes)) {}

Upload::~Upload() {
  if (fd_ >= 0) close(fd_);
  if (upload_id_.empty()) return;
  auto call = CallOf(remote_, "DELETE", kWritten, "uploadId=" + Escape(upload_id_, false));
  if (!call.ok()) return;
  AddChecksums(ChecksumsOf(""), *call);
  TransferOptions options = options_;
  options.call = {.deadline = absl::Now() + absl::Seconds(5)};  // also after a cancellation
  Call(*call, options).IgnoreError();
}

absl::Status Upload::Begin(const std::string& path) {
  fd_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  std::error_code error;
  bytes_ = std::filesystem::file_size(path, error);
  if (fd_ < 0 || error) {
    return absl::FailedPreconditionError(absl::StrCat(remote_.name, ": its local copy cannot be read (",
                                                      error ? error.message() : std::strerror(errno), ")"));
  }
  const uint64_t part = std::max(kPartBytes, (bytes_ + kMostParts - 1) / kMostParts);
  if (!remote_.is_s3() || bytes_ <= part) return absl::OkStatus();
  if (part > kMostPartBytes) {
    return absl::FailedPreconditionError(
        absl::StrCat(remote_.name, ": ", bytes_, " bytes exceed ", kMostParts * kMostPartBytes));
  }
  if (auto status = Start(); !status.ok()) return status;
  for (uint64_t at = 0; at < bytes_; at += part) {
    const int number = static_cast<int>(etags_.size()) + 1;
    if (auto status = SendPart(number, at, std::min(part, bytes_ - at)); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status Upload::Finish() { return upload_id_.empty() ? PutWhole() : Complete(); }

absl::Status Upload::Start() {
  auto call = CallOf(remote_, "POST", kWritten, "uploads=");
  if (!call.ok()) return call.status();
  const HttpBody nothing;
  call->body = &nothing;
  call->headers = {"Content-Type: application/octet-stream"};
  for (const auto& [name, value] : notes_) call->headers.push_back(absl::StrCat(kNotePrefix, name, ": ", value));
  AddChecksums(ChecksumsOf(""), *call);
  const auto answer = Call(*call, options_);
  if (!answer.ok()) return answer.status();
  pugi::xml_document document;
  if (document.load_buffer(answer->body.data(), answer->body.size())) {
    upload_id_ = document.child("InitiateMultipartUploadResult").child_value("UploadId");
  }
  if (!upload_id_.empty()) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(remote_.name, ": cannot be written (the answer has no UploadId)"));
}

absl::Status Upload::SendPart(int number, uint64_t offset, uint64_t bytes) {
  auto call =
      CallOf(remote_, "PUT", kWritten, absl::StrCat("partNumber=", number, "&uploadId=", Escape(upload_id_, false)));
  if (!call.ok()) return call.status();
  const HttpBody body{.fd = fd_, .offset = offset, .bytes = bytes};
  const Checksums sums = ChecksumsOfFile(fd_, offset, bytes);
  call->body = &body;
  AddChecksums(sums, *call);
  call->check = [&](const HttpAnswer& answer) { return Compare(remote_.name, answer, sums); };
  const auto answer = Call(*call, options_);
  if (!answer.ok()) return answer.status();
  etags_.push_back(answer->Header("etag"));
  return absl::OkStatus();
}

absl::Status Upload::PutWhole() {
  auto call = CallOf(remote_, "PUT", kWritten);
  if (!call.ok()) return call.status();
  const HttpBody body{.fd = fd_, .bytes = bytes_};
  const Checksums sums = ChecksumsOfFile(fd_, 0, bytes_);
  call->body = &body;
  AddChecksums(sums, *call);
  if (remote_.is_s3()) {  // headers of a URL are those that its signature has
    call->headers.emplace_back("Content-Type: application/octet-stream");
    if (!sums.sha256.empty()) {
      call->headers.push_back("x-amz-checksum-sha256: " + absl::Base64Escape(sums.sha256));
    }
    for (const auto& [name, value] : notes_) call->headers.push_back(absl::StrCat(kNotePrefix, name, ": ", value));
  }
  call->check = [&](const HttpAnswer& answer) { return Compare(remote_.name, answer, sums); };
  return Call(*call, options_).status();
}

absl::Status Upload::Complete() {
  auto call = CallOf(remote_, "POST", kWritten, "uploadId=" + Escape(upload_id_, false));
  if (!call.ok()) return call.status();
  HttpBody body{.text = "<CompleteMultipartUpload xmlns=\"http://s3.amazonaws.com/doc/2006-03-01/\">"};
  for (size_t n = 0; n < etags_.size(); ++n) {
    const std::string etag = absl::StrReplaceAll(etags_[n], {{"&", "&amp;"}, {"<", "&lt;"}});
    absl::StrAppend(&body.text, "<Part><PartNumber>", n + 1, "</PartNumber><ETag>", etag, "</ETag></Part>");
  }
  body.text += "</CompleteMultipartUpload>";
  call->body = &body;
  call->headers = {"Content-Type: application/xml"};
  AddChecksums(ChecksumsOf(body.text), *call);
  // S3 answers at once, and may tell the error afterward.
  call->check = [&](const HttpAnswer& answer) {
    if (absl::StrContains(answer.body, "<CompleteMultipartUploadResult")) return absl::OkStatus();
    HttpAnswer refusal = answer;
    refusal.status = 500;
    return RefusalOf(*call, refusal);
  };
  call->expected = {404};  // an earlier try did it, and its answer was lost
  const auto answer = Call(*call, options_);
  if (!answer.ok()) return answer.status();
  if (answer->status == 404) {
    const absl::Status done = answer->tries > 1 ? CheckCompleted() : RefusalOf(*call, *answer);
    if (!done.ok()) return done;
  }
  upload_id_.clear();
  return absl::OkStatus();
}

absl::Status Upload::CheckCompleted() {
  const auto facts = FactsOf(remote_, options_);
  if (!facts.ok()) return facts.status();
  if (*facts && (*facts)->bytes == bytes_ && (*facts)->notes == notes_) return absl::OkStatus();
  return absl::UnavailableError(absl::StrCat(remote_.name, ": cannot be written (its parts have disappeared)"));
}

}  // namespace latvox::client
