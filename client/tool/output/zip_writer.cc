#include "client/tool/output/zip_writer.h"

#include <fcntl.h>
#include <unistd.h>
#include <zip.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <memory>
#include <string_view>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "client/internal/file_error.h"
#include "client/tool/output/deflater.h"

namespace latvox::client {
namespace {

// libzip reads a member through this, which has compressed it already: libzip would do that in one thread.
class MemberSource {
 public:
  MemberSource(const ZipMember& member, const Cancellation& cancellation)
      : bytes_(member.bytes), stream_(member.next, Check::kCrc32), cancellation_(cancellation) {
    zip_error_init(&error_);
  }
  ~MemberSource() { zip_error_fini(&error_); }
  MemberSource(const MemberSource&) = delete;
  MemberSource& operator=(const MemberSource&) = delete;

  static zip_int64_t Call(void* self, void* data, zip_uint64_t size, zip_source_cmd_t command) {
    auto& source = *static_cast<MemberSource*>(self);
    switch (command) {
      case ZIP_SOURCE_SUPPORTS:
        return ZIP_SOURCE_SUPPORTS_READABLE;
      case ZIP_SOURCE_READ:
        return source.Read(static_cast<char*>(data), size);
      case ZIP_SOURCE_STAT:
        return source.Stat(static_cast<zip_stat_t*>(data));
      case ZIP_SOURCE_ERROR:
        return zip_error_to_data(&source.error_, data, size);
      default:  // open, close, free
        return 0;
    }
  }

 private:
  zip_int64_t Read(char* data, zip_uint64_t size) {
    if (cancellation_.cancelled()) {
      zip_error_set(&error_, ZIP_ER_CANCELLED, 0);
      return -1;
    }
    if (at_ == chunk_.size()) {
      if (!stream_.Next(chunk_).ok()) {
        zip_error_set(&error_, ZIP_ER_MEMORY, 0);
        return -1;
      }
      at_ = 0;
      is_whole_ = chunk_.empty();
    }
    const size_t count = std::min<size_t>(size, chunk_.size() - at_);
    std::memcpy(data, chunk_.data() + at_, count);
    at_ += count;
    return static_cast<zip_int64_t>(count);
  }

  // libzip asks for the checksum after the last byte.
  zip_int64_t Stat(zip_stat_t* stat) const {
    zip_stat_init(stat);
    stat->size = bytes_;
    stat->comp_method = ZIP_CM_DEFLATE;
    stat->valid = ZIP_STAT_SIZE | ZIP_STAT_COMP_METHOD;
    if (is_whole_) {
      stat->crc = stream_.check();
      stat->valid |= ZIP_STAT_CRC;
    }
    return sizeof(zip_stat_t);
  }

  const uint64_t bytes_;  // before compression
  DeflateStream stream_;
  const Cancellation& cancellation_;
  std::string chunk_;
  size_t at_ = 0;
  bool is_whole_ = false;
  zip_error_t error_;
};

// libzip writes the archive through this. Its own writer for files would leave a temporary file behind if the process
// is killed.
class ArchiveSink {
 public:
  explicit ArchiveSink(int fd) : fd_(fd) { zip_error_init(&error_); }
  ~ArchiveSink() { zip_error_fini(&error_); }
  ArchiveSink(const ArchiveSink&) = delete;
  ArchiveSink& operator=(const ArchiveSink&) = delete;

  static zip_int64_t Call(void* self, void* data, zip_uint64_t size, zip_source_cmd_t command) {
    auto& sink = *static_cast<ArchiveSink*>(self);
    switch (command) {
      case ZIP_SOURCE_SUPPORTS:
        return ZIP_SOURCE_SUPPORTS_WRITABLE;
      case ZIP_SOURCE_STAT:  // there is no archive yet
        zip_error_set(&sink.error_, ZIP_ER_READ, ENOENT);
        return -1;
      case ZIP_SOURCE_ERROR:
        return zip_error_to_data(&sink.error_, data, size);
      case ZIP_SOURCE_WRITE:
        return sink.Write({static_cast<const char*>(data), size});
      case ZIP_SOURCE_TELL_WRITE:
        return sink.at_;
      case ZIP_SOURCE_SEEK_WRITE:
        return sink.Seek(data, size);
      case ZIP_SOURCE_BEGIN_WRITE:
      case ZIP_SOURCE_COMMIT_WRITE:
      case ZIP_SOURCE_ROLLBACK_WRITE:
      case ZIP_SOURCE_FREE:
        return 0;
      default:
        zip_error_set(&sink.error_, ZIP_ER_OPNOTSUPP, 0);
        return -1;
    }
  }

 private:
  zip_int64_t Write(std::string_view bytes) {
    for (std::string_view rest = bytes; !rest.empty();) {
      const ssize_t count = pwrite(fd_, rest.data(), rest.size(), at_);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) {
        zip_error_set(&error_, ZIP_ER_WRITE, errno);
        return -1;
      }
      rest.remove_prefix(static_cast<size_t>(count));
      at_ += count;
    }
    end_ = std::max(end_, at_);
    return static_cast<zip_int64_t>(bytes.size());
  }

  zip_int64_t Seek(void* data, zip_uint64_t size) {
    const zip_int64_t to = zip_source_seek_compute_offset(static_cast<zip_uint64_t>(at_),
                                                          static_cast<zip_uint64_t>(end_), data, size, &error_);
    if (to < 0) return -1;
    at_ = to;
    return 0;
  }

  const int fd_;
  off_t at_ = 0, end_ = 0;
  zip_error_t error_;
};

absl::Status Add(MemberSource& source, const std::string& name, zip_t* archive) {
  constexpr zip_uint16_t kDate = 1 << 5 | 1;  // of MS-DOS: January 1, 1980
  zip_source_t* const content = zip_source_function(archive, &MemberSource::Call, &source);
  const zip_int64_t index = content == nullptr ? -1 : zip_file_add(archive, name.c_str(), content, 0);
  if (index < 0) zip_source_free(content);
  const auto number = static_cast<zip_uint64_t>(index);
  if (index < 0 || zip_set_file_compression(archive, number, ZIP_CM_DEFLATE, 0) != 0 ||
      zip_file_set_dostime(archive, number, 0, kDate, 0) != 0) {
    return absl::FailedPreconditionError(zip_strerror(archive));
  }
  return absl::OkStatus();
}

// `sink` and the members outlive the archive.
absl::Status Write(const std::vector<ZipMember>& members, const Cancellation& cancellation, ArchiveSink& sink) {
  zip_error_t error;
  zip_error_init(&error);
  const absl::Cleanup forget = [&error] { zip_error_fini(&error); };
  zip_source_t* const target = zip_source_function_create(&ArchiveSink::Call, &sink, &error);
  zip_t* const archive = target == nullptr ? nullptr : zip_open_from_source(target, ZIP_CREATE | ZIP_TRUNCATE, &error);
  if (archive == nullptr) {
    zip_source_free(target);
    return absl::FailedPreconditionError(zip_error_strerror(&error));
  }
  std::deque<MemberSource> sources;
  absl::Status status;
  for (const ZipMember& member : members) {
    status = Add(sources.emplace_back(member, cancellation), member.name, archive);
    if (!status.ok()) break;
  }
  if (status.ok() && zip_close(archive) == 0) return status;
  if (status.ok()) status = absl::FailedPreconditionError(zip_strerror(archive));
  zip_discard(archive);
  return status;
}

}  // namespace

absl::Status WriteZip(const std::vector<ZipMember>& members, AtomicFile& file) {
  const auto cannot = [&file](absl::string_view why) {
    return WithFile(absl::FailedPreconditionError(absl::StrCat(file.target(), ": cannot be written (", why, ")")),
                    "--out", file.target());
  };
  const int fd = open(file.temporary().c_str(), O_WRONLY | O_CLOEXEC);
  if (fd < 0) return cannot(std::strerror(errno));
  const absl::Cleanup close_file = [fd] { close(fd); };
  ArchiveSink sink(fd);
  const absl::Status status = Write(members, file.cancellation(), sink);
  if (auto stopped = file.CheckGoesOn(); !stopped.ok()) return stopped;
  return status.ok() ? status : cannot(status.message());
}

}  // namespace latvox::client
