#include "client/tool/remote/checksum.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <vector>

namespace latvox::client {

Checksum::Checksum() : sha256_(Start(EVP_sha256())), md5_(Start(EVP_md5())) {}

Checksum::Context Checksum::Start(const EVP_MD* kind) {
  Context context(EVP_MD_CTX_new());
  if (context != nullptr && EVP_DigestInit_ex(context.get(), kind, nullptr) != 1) context.reset();
  return context;
}

std::string Checksum::Finish(const Context& context) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  if (context == nullptr || EVP_DigestFinal_ex(context.get(), digest, &size) != 1) return "";
  return {reinterpret_cast<const char*>(digest), size};
}

void Checksum::Add(std::string_view bytes) {
  for (const Context* context : {&sha256_, &md5_}) {
    if (*context != nullptr) EVP_DigestUpdate(context->get(), bytes.data(), bytes.size());
  }
}

Checksums Checksum::Finish() { return {Finish(sha256_), Finish(md5_)}; }

Checksums ChecksumsOf(std::string_view text) {
  Checksum checksum;
  checksum.Add(text);
  return checksum.Finish();
}

Checksums ChecksumsOfFile(int fd, uint64_t offset, uint64_t bytes) {
  Checksum checksum;
  std::vector<char> buffer(size_t{1} << 18);
  while (bytes > 0) {
    const size_t wanted = std::min<uint64_t>(buffer.size(), bytes);
    const ssize_t n = pread(fd, buffer.data(), wanted, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    checksum.Add({buffer.data(), static_cast<size_t>(n)});
    offset += static_cast<uint64_t>(n);
    bytes -= static_cast<uint64_t>(n);
  }
  return checksum.Finish();
}

}  // namespace latvox::client
