// Benchmarks of the codec of bricks on the wire; part of latvox_bench_kernels.
#ifndef LATVOX_TESTS_BENCH_CODEC_KERNELS_H_
#define LATVOX_TESTS_BENCH_CODEC_KERNELS_H_

namespace latvox {

// Registers Codec/SCENE/WAY. bytes_per_second counts raw bricks, 76 bytes each. The counter bits_per_voxel counts whole
// messages. The ways:
//   memcpy                             the limit of the machine
//   pack, unpack, both                 BRICK_ENCODING_PACKED: bricks to messages, messages to bricks, both in turn
//   zstd_pack, zstd_unpack, zstd_both  BRICK_ENCODING_PACKED_ZSTD
void RegisterCodec();

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_CODEC_KERNELS_H_
