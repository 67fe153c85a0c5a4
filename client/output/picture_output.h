// The output .png.
#ifndef LATVOX_CLIENT_OUTPUT_PICTURE_OUTPUT_H_
#define LATVOX_CLIENT_OUTPUT_PICTURE_OUTPUT_H_

#include <memory>

#include "client/mesh/up_axis.h"
#include "client/output/atomic_file.h"
#include "client/output/output.h"

namespace latvox::client {

std::unique_ptr<Output> NewPictureOutput(std::unique_ptr<AtomicFile> file, UpAxis up);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_OUTPUT_PICTURE_OUTPUT_H_
