/* The reference decoder as a WebAssembly module, for src/wasm.js. An instance holds one set, so that the set's memory
 * goes when the instance goes. Everything is taken from a heap that only grows; its pointers are offsets in the
 * instance's memory. */
#define NMC_SQRT(x) __builtin_sqrt(x)
#define NMC_DECODE_IMPLEMENTATION
#include "nmc_decode.h"

#define WASM_EXPORT(name) __attribute__((export_name(#name)))

enum {
  WASM_PAGE = 65536,
  WASM_NO_MEMORY = -1,      /* beside the results of nmc_open */
  WASM_KEY_FLOATS = 1 << 16 /* of keys that are decoded at a time; a sample has at most as many */
};

/* The poses of the two samples around the time that a clip was asked for last; playing seldom asks for others. */
typedef struct wasm_near {
  float *poses[2]; /* NULL: not asked yet */
  uint32_t samples[2];
} wasm_near;

extern uint8_t __heap_base;
static uint8_t *heap;
static nmc_set set;
static void *scratch;
static wasm_near *nears; /* per clip */
static float *pose;
static float *keys;
typedef char wasm_keys_fit[sizeof(struct nmc_models) >= WASM_KEY_FLOATS * sizeof(float) ? 1 : -1];

/* clang makes calls of these where a size is not known; with bulk memory they are one instruction. */
void *memcpy(void *to, const void *from, size_t size) { return __builtin_memcpy(to, from, size); }
void *memset(void *to, int value, size_t size) { return __builtin_memset(to, value, size); }

static int wasm_grow(uint64_t end) {
  const uint64_t there = (uint64_t)__builtin_wasm_memory_size(0) * WASM_PAGE;
  if (end <= there) return 1;
  return end <= UINT32_MAX &&
         __builtin_wasm_memory_grow(0, (size_t)((end - there + WASM_PAGE - 1) / WASM_PAGE)) != SIZE_MAX;
}

/* Memory aligned to 8 bytes, zeros if nobody wrote to it; NULL if there is no more. */
WASM_EXPORT(reserve) void *wasm_reserve(size_t bytes) {
  const uintptr_t begin = (uintptr_t)nmc__pad((uintptr_t)(heap ? heap : &__heap_base));
  const uint64_t end = begin + nmc__pad(bytes);
  if (!wasm_grow(end)) return NULL;
  heap = (uint8_t *)(uintptr_t)end;
  return (void *)begin;
}

/* Opens the stream at `bytes`, which a reserve before gave. Returns an nmc_result or WASM_NO_MEMORY. */
WASM_EXPORT(open) int wasm_open(const uint8_t *bytes, size_t size) {
  nmc_info info;
  void *workspace;
  nmc_result result = nmc_read_info(bytes, size, &info);
  if (result != NMC_OK) return (int)result;
  workspace = wasm_reserve(info.workspace_bytes);
  scratch = wasm_reserve(info.scratch_bytes);
  nears = wasm_reserve(info.clips * sizeof(wasm_near));
  pose = wasm_reserve(info.slots * sizeof(float));
  if (!workspace || !scratch || !nears || !pose) return WASM_NO_MEMORY;
  result = nmc_open(&set, bytes, size, workspace, info.workspace_bytes);
  keys = (float *)(void *)set.models; /* a set that is open has no more use for them */
  return (int)result;
}

WASM_EXPORT(slots) uint32_t wasm_slots(void) { return set.info.slots; }
WASM_EXPORT(targets) uint32_t wasm_targets(void) { return set.info.targets; }
WASM_EXPORT(clips) uint32_t wasm_clips(void) { return set.info.clips; }
WASM_EXPORT(path) uint32_t wasm_path(uint32_t target) { return set.targets[target].path; }
WASM_EXPORT(width) uint32_t wasm_width(uint32_t target) { return set.targets[target].width; }
WASM_EXPORT(samples) uint32_t wasm_samples(uint32_t clip) { return set.clips[clip].samples; }
WASM_EXPORT(times) const float *wasm_times(uint32_t clip) { return nmc_times(&set, clip); }
WASM_EXPORT(states) const uint8_t *wasm_states(uint32_t clip) { return set.states + (size_t)clip * set.info.targets; }

/* Where evaluate and decode put what they find. */
WASM_EXPORT(pose) const float *wasm_pose(void) { return pose; }
WASM_EXPORT(keys) const float *wasm_keys(void) { return keys; }

/* Which of the two poses holds sample n: one that is there, or the one that is not `kept`. */
static uint32_t wasm_sample(wasm_near *near, uint32_t clip, uint32_t n, uint32_t kept) {
  uint32_t place;
  for (place = 0; place < 2; ++place)
    if (near->samples[place] == n) return place;
  place = kept == 0 ? 1 : 0;
  nmc_sample(&set, clip, n, near->poses[place], scratch);
  near->samples[place] = n;
  return place;
}

static int wasm_start(wasm_near *near) {
  float *poses = near->poses[0] ? near->poses[0] : wasm_reserve(2 * set.info.slots * sizeof(float));
  if (!poses) return 0;
  if (near->poses[0]) return 1;
  near->poses[0] = poses;
  near->poses[1] = poses + set.info.slots;
  near->samples[0] = near->samples[1] = UINT32_MAX;
  return 1;
}

static void wasm_slerp(const float *a, const float *b, const nmc__between *between, float *out) {
  static const double identity[4] = {0, 0, 0, 1};
  double from[4], to[4], made[4];
  int i;
  for (i = 0; i < 4; ++i) {
    from[i] = a[i];
    to[i] = b[i];
  }
  nmc__slerp(from, to, between, made);
  nmc__turned(identity, made, out);
}

/* From a pose to the next one of the clip; of the targets that do not move, `a` has the value. */
static void wasm_mix(uint32_t clip, const float *a, const float *b, double u, float *out) {
  nmc__between between;
  uint32_t t, i;
  nmc__start_between(u, &between);
  for (t = 0; t < set.info.targets; ++t) {
    const nmc_target *target = &set.targets[t];
    const uint32_t begin = target->offset, end = begin + target->width;
    const int moves = nmc_state(&set, clip, t) >= NMC_MOVING;
    if (moves && target->path == NMC_ROTATION) {
      wasm_slerp(a + begin, b + begin, &between, out + begin);
    } else {
      for (i = begin; i < end; ++i) out[i] = moves ? (float)((1 - u) * a[i] + u * b[i]) : a[i];
    }
  }
}

/* The pose at a time, before the first and after the last key that key. Returns 0 if there is no memory for it. */
WASM_EXPORT(evaluate) int wasm_evaluate(uint32_t clip, double seconds) {
  wasm_near *near = &nears[clip];
  uint32_t n, a, b;
  double u;
  if (!wasm_start(near)) return 0;
  u = nmc__locate(nmc_times(&set, clip), set.clips[clip].samples, seconds, &n);
  a = wasm_sample(near, clip, n, near->samples[0] == n + 1 ? 0 : 1);
  if (u == 0) {
    memcpy(pose, near->poses[a], set.info.slots * sizeof(float));
  } else {
    b = wasm_sample(near, clip, n + 1, a);
    wasm_mix(clip, near->poses[a], near->poses[b], u, pose);
  }
  return 1;
}

/* Samples first ... first + count - 1 of the moving targets: target after target, sample after sample. The last one's
 * pose stays in `pose`. */
WASM_EXPORT(decode) void wasm_decode(uint32_t clip, uint32_t first, uint32_t count) {
  uint32_t n, t, a;
  for (n = 0; n < count; ++n) {
    float *out = keys;
    nmc_sample(&set, clip, first + n, pose, scratch);
    for (t = 0; t < set.info.targets; ++t) {
      const nmc_target *target = &set.targets[t];
      if (nmc_state(&set, clip, t) < NMC_MOVING) continue;
      for (a = 0; a < target->width; ++a) out[n * target->width + a] = pose[target->offset + a];
      out += (size_t)count * target->width;
    }
  }
}
