// Benchmarks of what bricks go through on the wire; part of latvox_bench_kernels.
#ifndef LATVOX_TESTS_BENCH_CODEC_KERNELS_H_
#define LATVOX_TESTS_BENCH_CODEC_KERNELS_H_

namespace latvox {

// Codec/SCENE/WAY: bytes_per_second are of raw bricks, 76 bytes each. The counter bits_per_voxel is of all messages,
// whole. The ways:
//   memcpy                          what the machine can do at all
//   pack, unpack, both              BRICK_ENCODING_PACKED: messages from bricks, bricks from messages, one after the
//   other zstd_pack, zstd_unpack, zstd_both  BRICK_ENCODING_PACKED_ZSTD
void RegisterCodec();

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_CODEC_KERNELS_H_
