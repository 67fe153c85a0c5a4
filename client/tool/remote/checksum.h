// Checksums of bytes on their way.
#ifndef LATVOX_CLIENT_TOOL_REMOTE_CHECKSUM_H_
#define LATVOX_CLIENT_TOOL_REMOTE_CHECKSUM_H_

#include <openssl/evp.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace latvox::client {

// Raw bytes. A digest is empty if libcrypto does not offer it, as some machines do not offer MD5.
struct Checksums {
  std::string sha256;  // 32
  std::string md5;     // 16
};

// Computes both. Not thread-safe.
class Checksum {
 public:
  Checksum();
  void Add(std::string_view bytes);
  // Call it once.
  Checksums Finish();

 private:
  struct Free {
    void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
  };
  using Context = std::unique_ptr<EVP_MD_CTX, Free>;

  static Context Start(const EVP_MD* kind);
  static std::string Finish(const Context& context);

  Context sha256_, md5_;  // null: not offered
};

// Returns those of text, or of `bytes` bytes of a file from `offset` on. They are of fewer bytes if the file ends
// there.
Checksums ChecksumsOf(std::string_view text);
Checksums ChecksumsOfFile(int fd, uint64_t offset, uint64_t bytes);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_REMOTE_CHECKSUM_H_
