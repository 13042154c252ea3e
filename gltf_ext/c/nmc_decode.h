/* nmc_decode.h: the reference decoder of NMC_animation_compression streams. C99, one header, no dependency, no
 * allocation.
 *
 * In exactly one C or C++ file:
 *     #define NMC_DECODE_IMPLEMENTATION
 *     #include "nmc_decode.h"
 *
 * Use:
 *     nmc_info info;
 *     if (nmc_read_info(bytes, size, &info) != NMC_OK) ...            sizes of everything, before anything is allocated
 *     void *workspace = malloc(info.workspace_bytes);                 aligned to 8 bytes
 *     nmc_set set;
 *     if (nmc_open(&set, bytes, size, workspace, info.workspace_bytes) != NMC_OK) ...       checks the whole stream
 *     void *scratch = malloc(info.scratch_bytes);                     aligned to 8 bytes, one per thread
 *     float *pose = malloc(info.slots * sizeof(float));
 *     nmc_evaluate(&set, clip, seconds, NMC_CLAMP, pose, scratch);
 *
 * A stream is a clip set: targets (node properties of one character) and clips that move them. A pose is the
 * concatenation of all targets' values: 3 floats for a translation or scale, 4 for a rotation (unit quaternion x, y, z,
 * w), n for n morph weights. `bytes` need not stay alive after nmc_open; `workspace` must. After nmc_open a set is
 * never written again: any number of threads may evaluate it at once, each with its own scratch.
 */
#ifndef NMC_DECODE_H
#define NMC_DECODE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum nmc_result {
  NMC_OK = 0,
  NMC_ERROR_TRUNCATED = 1, /* the stream ends too early, or is too short for what it holds */
  NMC_ERROR_MAGIC = 2,     /* the first three bytes are not "NMC" */
  NMC_ERROR_VERSION = 3,   /* a version of the bitstream that this decoder does not know */
  NMC_ERROR_CHECKSUM = 4,  /* the bytes were changed */
  NMC_ERROR_LIMIT = 5,     /* a count is above the format's limits */
  NMC_ERROR_CORRUPT = 6,   /* a value contradicts the header or another value */
  NMC_ERROR_ARGUMENT = 7   /* the caller's memory is too small, or an index is out of range */
} nmc_result;

/* One sentence for a result: that of the table "Refusals" in the specification. */
const char *nmc_message(nmc_result result);

enum { NMC_VERSION = 1 }; /* append-only; a number is never given a second meaning */

enum { NMC_TRANSLATION = 0, NMC_ROTATION = 1, NMC_SCALE = 2, NMC_WEIGHTS = 3 };

/* What happens outside a clip's first and last key time. */
enum { NMC_CLAMP = 0, NMC_LOOP = 1 };

/* How a clip holds a target. */
enum {
  NMC_ABSENT = 0,    /* the clip does not move it: the value is the set's reference, and no channel is to be made */
  NMC_STATIC = 1,    /* one value for the whole clip */
  NMC_MOVING = 2,    /* numbers as they are; a rotation as rotation vector about the reference */
  NMC_QUATERNION = 3 /* a rotation as four numbers */
};

/* A clip's features f_j. */
enum {
  NMC_COSINE = 0,   /* one window, one anchor pose, cos(pi j (2 n + 1) / (2 N)) */
  NMC_PERIODIC = 1, /* one window between two anchor poses, cos and sin of whole cycles over N - 1 samples */
  NMC_SINE = 2      /* windows between anchor poses, sin(pi j (n - begin) / length) */
};

/* What a stream holds, from its header. */
typedef struct nmc_info {
  uint32_t slots; /* floats in a pose */
  uint32_t targets;
  uint32_t clips;
  uint32_t samples; /* key times of all clips together */
  uint32_t windows;
  uint32_t anchors; /* numbers in all anchor poses */
  uint32_t weights; /* nonzero weights of all windows */
  uint32_t atoms;
  uint32_t max_features; /* the largest feature index of any window */
  uint32_t dense;        /* numbers in network tensors and frequency lists */
  uint32_t hidden0;      /* widths of the network's hidden layers */
  uint32_t hidden1;
  uint32_t max_frequencies;
  uint32_t header_bytes;
  size_t workspace_bytes;
  size_t scratch_bytes;
} nmc_info;

typedef struct nmc_target {
  uint8_t path;    /* NMC_TRANSLATION ... NMC_WEIGHTS */
  uint16_t width;  /* floats in a pose: 3, 4, or the number of morph weights */
  uint32_t offset; /* of its first float in a pose */
} nmc_target;

typedef struct nmc_weight {
  uint16_t feature;   /* j, from 1 */
  uint16_t parameter; /* index among the clip's parameters */
  float value;
} nmc_weight;

typedef struct nmc_window {
  uint32_t begin;  /* first sample */
  uint32_t length; /* samples to the next window's begin */
  uint32_t first_weight;
  uint32_t weights;
  uint32_t features; /* largest feature index used */
} nmc_window;

/* An atom: value times a raised cosine of half-width 2^width samples around a sample. Of width NMC_JUMP: the parameter
 * jumps by value between the sample before and this one; the line between the anchors of the window that both are in
 * has that already, as a slope, which is taken away. */
#define NMC_JUMP 17
typedef struct nmc_atom {
  uint32_t sample;
  uint16_t parameter;
  uint16_t width;
  float value;
} nmc_atom;

typedef struct nmc_clip {
  uint32_t samples;
  uint32_t first_time;
  uint32_t first_window;
  uint32_t windows;
  uint32_t first_anchor;
  uint32_t anchor_rows;
  uint32_t first_atom;
  uint32_t atoms;
  uint32_t parameters;   /* numbers that the clip stores per pose */
  uint32_t outputs;      /* of them, those of moving targets */
  uint32_t frequencies;  /* of the network's clip layer */
  uint32_t first_dense;  /* its frequencies (half cycles), W0 (hidden0 x 2K + 1, column by column), b0 */
  int32_t reference;     /* the earlier clip whose last anchor pose predicts this one's first, or -1 */
  int32_t step_exponent; /* the weights' steps are multiplied by 2^(-exponent / 4) */
  int32_t time_first;
  uint32_t time_rate;
  float time_start;
  double time_step;
  uint8_t basis;
  uint8_t time_mode;
  uint8_t time_exact;   /* 1: the time formula needs no corrections */
  uint8_t even_windows; /* 1: windows of equal length */
  uint8_t widest;       /* largest width of its atoms that are no jumps */
  uint8_t jumps;        /* 1: some of its atoms are jumps */
} nmc_clip;

struct nmc_models;

typedef struct nmc_set {
  nmc_info info;
  uint8_t exact_references; /* references are float32 values, not whole steps */
  uint8_t has_network;
  uint8_t quantized_network; /* tensors are whole steps, not float32 */
  uint32_t outputs;          /* rows of W2: the parameters of moving targets of each clip */
  uint32_t first_shared;     /* in dense: W1 (hidden1 x hidden0), b1, W2 (outputs x hidden1), b2 */
  float base_step;
  int32_t anchor_exponent; /* the anchors' steps are multiplied by 2^(-exponent / 4) */
  nmc_clip *clips;
  nmc_target *targets;
  int32_t *step_exponents; /* per slot: step = base_step * 2^(-exponent / 2) */
  float *references;       /* per slot, as stored: rotation vectors, offsets from the default value */
  float *pose;             /* per slot: the reference pose */
  nmc_window *windows;
  nmc_weight *weights;
  nmc_atom *atoms;
  float *times;
  float *anchors;
  float *dense;
  int32_t *levels;  /* per slot: the pose that predicts the next anchor pose */
  uint8_t *states;  /* clips x targets */
  uint8_t *classes; /* slots x (max_features + 1): bit lengths of the last levels, for contexts */
  uint8_t *lengths; /* per slot: bit length of the last feature count; then of the last anchor difference */
  struct nmc_models *models;
} nmc_set;

/* Reads the header alone and says how much memory the stream needs. Does not look at the payload. */
nmc_result nmc_read_info(const void *bytes, size_t size, nmc_info *info);

/* Decodes the whole stream into `workspace` (8-byte aligned, info.workspace_bytes long) and checks all of it. */
nmc_result nmc_open(nmc_set *set, const void *bytes, size_t size, void *workspace, size_t workspace_bytes);

/* Key times (seconds) of a clip, set->clips[clip].samples of them: bit for bit those of the original. */
const float *nmc_times(const nmc_set *set, uint32_t clip);

/* How a clip holds a target: NMC_ABSENT, NMC_STATIC, NMC_MOVING or NMC_QUATERNION. */
int nmc_state(const nmc_set *set, uint32_t clip, uint32_t target);

/* The pose at sample n of a clip. pose: info.slots floats; scratch: info.scratch_bytes, 8-byte aligned. */
nmc_result nmc_sample(const nmc_set *set, uint32_t clip, uint32_t n, float *pose, void *scratch);

/* The pose at a time: between samples what glTF's LINEAR gives (slerp for rotations). mode: NMC_CLAMP or NMC_LOOP. */
nmc_result nmc_evaluate(const nmc_set *set, uint32_t clip, double seconds, int mode, float *pose, void *scratch);

#ifdef NMC_ENCODER
/* For the encoder. One routine reads and writes a payload, so that the two cannot differ: nmc_write_payload takes a set
 * whose values are whole levels. `put` gets every byte (NULL: none, bits are only counted). */
enum {
  NMC_PART_HEADER,
  NMC_PART_REFERENCES,
  NMC_PART_TIMES,
  NMC_PART_STATES,
  NMC_PART_ANCHORS,
  NMC_PART_WEIGHTS,
  NMC_PART_ATOMS,
  NMC_PART_NETWORK,
  NMC_PARTS
};
typedef struct nmc_sink {
  void (*put)(void *user, uint8_t byte);
  void *user;
  double bits[NMC_PARTS]; /* ideal code lengths by part */
  uint64_t decisions;
} nmc_sink;
nmc_result nmc_write_payload(nmc_set *set, nmc_sink *sink);
nmc_result nmc_carve(nmc_set *set, void *workspace,
                     size_t workspace_bytes); /* points the arrays of a set with a filled info into memory */
void nmc_measure(nmc_info *info);             /* workspace_bytes and scratch_bytes from the counts */
uint32_t nmc_checksum(const uint8_t *bytes, size_t size);
/* Key time n by the clip's formula (time_mode ... time_step); mode 3 goes on from the time before. */
float nmc_formula_time(const nmc_clip *clip, uint32_t n, float previous);
void nmc_features(const nmc_clip *clip, const nmc_window *window, uint32_t n, uint32_t count,
                  double *features); /* features[j], j = 1 .. count */
/* nmc_open that also says where the bits go: bits holds NMC_PARTS numbers for the whole set, then for each clip. */
nmc_result nmc_open_counting(nmc_set *set, const void *bytes, size_t size, void *workspace, size_t workspace_bytes,
                             double *bits);
#endif

#ifdef __cplusplus
}
#endif
#endif /* NMC_DECODE_H */

#ifdef NMC_DECODE_IMPLEMENTATION
#ifndef NMC_DECODE_IMPLEMENTED
#define NMC_DECODE_IMPLEMENTED

#include <string.h>

#ifndef NMC_SQRT
#include <math.h>
#define NMC_SQRT(x) sqrt(x)
#endif
#ifdef NMC_ENCODER
#include <math.h>
#endif

/* For the few functions that every decision of a stream calls: also a build for size is to have them inline. */
#ifdef __GNUC__
#define NMC__INLINE static inline __attribute__((always_inline))
#else
#define NMC__INLINE static inline
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Limits of version 1 ---- */

enum {
  NMC__MAX_SLOTS = 65535,
  NMC__MAX_CLIPS = 65535,
  NMC__MAX_FEATURES = 65535,
  NMC__MAX_SAMPLES = 1 << 27,
  NMC__MAX_HIDDEN = 4096,
  NMC__LEVEL_BITS = 23,          /* levels fit a float exactly */
  NMC__DECISIONS_PER_BYTE = 512, /* of a payload, plus NMC__FREE_DECISIONS */
  NMC__FREE_DECISIONS = 65536
};

const char *nmc_message(nmc_result result) {
  switch (result) {
    case NMC_OK:
      return "the stream is good";
    case NMC_ERROR_TRUNCATED:
      return "the stream ends too early";
    case NMC_ERROR_MAGIC:
      return "the stream does not begin with \"NMC\"";
    case NMC_ERROR_VERSION:
      return "the stream has a version that this decoder does not know";
    case NMC_ERROR_CHECKSUM:
      return "the stream's bytes do not match its checksum";
    case NMC_ERROR_LIMIT:
      return "a count in the stream is above the format's limits";
    case NMC_ERROR_CORRUPT:
      return "a value in the stream contradicts another";
    case NMC_ERROR_ARGUMENT:
      return "the caller's memory is too small or an index is out of range";
  }
  return "unknown result";
}

/* ---- Numbers: own elementary functions, so that every platform gives the same poses ---- */

static const double nmc__pi = 3.14159265358979323846;

static int64_t nmc__round(double x) { return (int64_t)(x < 0 ? x - 0.5 : x + 0.5); }

/* sin x / x and cos x of y = x * x, |x| <= pi / 4, error below 1e-11. */
static double nmc__sine_ratio(double y) { /* terms in pairs do not wait for each other */
  const double y2 = y * y;
  return (1 + y * (-1.0 / 6)) + y2 * ((1.0 / 120 + y * (-1.0 / 5040)) + y2 * (1.0 / 362880 + y * (-1.0 / 39916800)));
}

static double nmc__cosine(double y) {
  const double y2 = y * y;
  return (1 + y * (-1.0 / 2)) +
         y2 * ((1.0 / 24 + y * (-1.0 / 720)) + y2 * ((1.0 / 40320 + y * (-1.0 / 3628800)) + y2 * (1.0 / 479001600)));
}

/* 1 / sqrt(1 + d), |d| < 1e-4. */
static double nmc__near_inverse_root(double d) { return 1 - d * (0.5 - 0.375 * d); }

/* 1 / sqrt(x); of what is 1 but for rounding without the root. */
static double nmc__inverse_root(double x) {
  const double d = x - 1;
  return d > -1e-4 && d < 1e-4 ? nmc__near_inverse_root(d) : 1 / NMC_SQRT(x);
}

/* sin and cos of 2 pi turns, |turns| < 2^52, error below 1e-11; of anything else those of 0, so that a stream with
 * senseless values is harmless. */
static void nmc__sin_cos(double turns, double *sine, double *cosine) {
  const double quarter = turns > -4e15 && turns < 4e15 ? (double)nmc__round(turns * 4) : 0;
  const double x = turns > -4e15 && turns < 4e15 ? (turns - quarter / 4) * 2 * nmc__pi : 0, y = x * x;
  const double s = x * nmc__sine_ratio(y), c = nmc__cosine(y);
  switch ((int64_t)quarter & 3) {
    case 0:
      *sine = s;
      *cosine = c;
      break;
    case 1:
      *sine = c;
      *cosine = -s;
      break;
    case 2:
      *sine = -s;
      *cosine = -c;
      break;
    default:
      *sine = -c;
      *cosine = s;
      break;
  }
}

/* The angle in [0, pi / 2] whose tangent is y / x, for x, y >= 0, not both 0. */
static double nmc__angle(double y, double x) {
  const int steep = y > x;
  double t = steep ? x / y : y / x, z;
  int i;
  for (i = 0; i < 2; ++i) t = t / (1 + NMC_SQRT(1 + t * t));
  z = t * t;
  t = 4 * t *
      (1 + z * (-1.0 / 3 + z * (1.0 / 5 + z * (-1.0 / 7 + z * (1.0 / 9 + z * (-1.0 / 11 + z * (1.0 / 13 - z / 15)))))));
  return steep ? nmc__pi / 2 - t : t;
}

/* e^x for x <= 0; 0 for what is not a number. */
static double nmc__exp(double x) {
  const double t = x * 1.44269504088896340736;
  const int64_t whole = t > -1000 ? nmc__round(t) : -1000;
  const double r = (t - (double)whole) * 0.69314718055994530942;
  double e = 1 + r * (1 + r * (0.5 + r * (1.0 / 6 + r * (1.0 / 24 + r * (1.0 / 120 + r * (1.0 / 720 + r / 5040))))));
  int64_t k = -whole;
  double half = 0.5;
  if (!(t > -1000)) return 0;
  for (; k > 0; k >>= 1, half *= half)
    if (k & 1) e *= half;
  return whole > 0 ? e * 2 : e;
}

/* 2^(-quarters / 4), |quarters| <= 512. */
static double nmc__power(int32_t quarters) {
  static const double root[4] = {1.0, 0.84089641525371454303, 0.70710678118654752440, 0.59460355750136053336};
  double p;
  int32_t whole = quarters >= 0 ? quarters / 4 : -((3 - quarters) / 4);
  p = root[quarters - 4 * whole];
  for (; whole > 0; --whole) p *= 0.5;
  for (; whole < 0; ++whole) p *= 2;
  return p;
}

/* ---- Header ---- */

static uint32_t nmc__crc(const uint8_t *bytes, size_t size) {
  uint32_t crc = 0xffffffffu;
  size_t i;
  int k;
  for (i = 0; i < size; ++i) {
    crc ^= bytes[i];
    for (k = 0; k < 8; ++k) crc = (crc >> 1) ^ (0xedb88320u & (0u - (crc & 1u)));
  }
  return ~crc;
}

static nmc_result nmc__varint(const uint8_t *bytes, size_t size, uint32_t *at, uint32_t *value) {
  uint64_t v = 0;
  int shift;
  for (shift = 0; shift < 35; shift += 7) {
    uint8_t b;
    if (*at >= size) return NMC_ERROR_TRUNCATED;
    b = bytes[(*at)++];
    v |= (uint64_t)(b & 127u) << shift;
    if (b < 128) {
      *value = (uint32_t)v;
      return v >> 32 ? NMC_ERROR_LIMIT : NMC_OK;
    }
  }
  return NMC_ERROR_LIMIT;
}

typedef struct nmc__bit_model {
  uint16_t p; /* probability of a one, of 65536 */
  uint16_t n; /* how often it was used, up to a limit */
} nmc__bit_model;

enum {
  NMC__LEVELS = 12, /* unary steps with models of their own */
  NMC__INPUTS = 6,
  /* Contexts of the mixed groups: where each input's table begins, in runs of NMC__LEVELS models. */
  NMC__WEIGHT_A = 0,
  NMC__WEIGHT_B = NMC__WEIGHT_A + 8 * 8 * 8,
  NMC__WEIGHT_C = NMC__WEIGHT_B + 8 * 8 * 3,
  NMC__WEIGHT_D = NMC__WEIGHT_C + 16 * 8,
  NMC__WEIGHT_E = NMC__WEIGHT_D + 512 * 4,
  NMC__WEIGHT_F = NMC__WEIGHT_E + 8 * 8 * 8,
  NMC__COUNT_A = NMC__WEIGHT_F + 64 * 4,
  NMC__COUNT_B = NMC__COUNT_A + 12 * 12,
  NMC__COUNT_C = NMC__COUNT_B + 12 * 3 * 4,
  NMC__ANCHOR_A = NMC__COUNT_C + 512,
  NMC__ANCHOR_B = NMC__ANCHOR_A + 12 * 3 * 4 * 3,
  NMC__ANCHOR_C = NMC__ANCHOR_B + 12 * 12 * 3,
  NMC__REFERENCE_A = NMC__ANCHOR_C + 512,
  NMC__TENSOR_A = NMC__REFERENCE_A + 12 * 4,
  NMC__TENSOR_B = NMC__TENSOR_A + 12 * 12 * 6,
  NMC__SIMPLE = NMC__TENSOR_B + 12 * 6,
  /* Simple numbers, one context each. */
  NMC__S_COUNT = 0,
  NMC__S_TIME,
  NMC__S_TIME_ERROR,
  NMC__S_CLIP_EXPONENT,
  NMC__S_REFERENCE,
  NMC__S_ATOM_GAP,
  NMC__S_ATOM_PARAMETER,
  NMC__S_ATOM_WIDTH,
  NMC__S_ATOM_VALUE,
  NMC__S_FREQUENCY,
  NMC__S_FLAG,
  NMC__S_STATE,
  NMC__S_SIMPLES = NMC__S_STATE + 64,
  NMC__RUNS = NMC__SIMPLE + NMC__S_SIMPLES,
  NMC__GROUPS = 6, /* weights, counts, anchors, references, tensors, simple */
  NMC__MANTISSAS = NMC__GROUPS * 32 * 4
};

struct nmc_models {
  nmc__bit_model runs[NMC__RUNS * NMC__LEVELS];
  nmc__bit_model mantissas[NMC__MANTISSAS];
  nmc__bit_model signs[NMC__GROUPS * 3 * 3];
  int32_t mixers[NMC__GROUPS * NMC__LEVELS * NMC__INPUTS];
  int16_t stretch[4096];
  uint16_t rate[64];
};

static uint64_t nmc__pad(uint64_t bytes) { return (bytes + 7) & ~(uint64_t)7; }

/* More than the address space holds stays too much, so that no allocation of it succeeds. */
static size_t nmc__size(uint64_t bytes) { return (size_t)bytes == bytes ? (size_t)bytes : SIZE_MAX; }

static uint64_t nmc__inputs(const nmc_info *i) { return 2 * (uint64_t)i->max_frequencies + 1; }

/* Counts are bounded before this, so that 64-bit sums cannot overflow. */
static void nmc__measure(nmc_info *i) {
  uint64_t w = 0, s = 0;
  w += nmc__pad(sizeof(struct nmc_models));
  w += nmc__pad((uint64_t)i->clips * sizeof(nmc_clip));
  w += nmc__pad((uint64_t)i->targets * sizeof(nmc_target));
  w += nmc__pad((uint64_t)i->slots * sizeof(int32_t)) * 2;
  w += nmc__pad((uint64_t)i->slots * sizeof(float)) * 2;
  w += nmc__pad((uint64_t)i->windows * sizeof(nmc_window));
  w += nmc__pad((uint64_t)i->weights * sizeof(nmc_weight));
  w += nmc__pad((uint64_t)i->atoms * sizeof(nmc_atom));
  w += nmc__pad((uint64_t)i->samples * sizeof(float));
  w += nmc__pad((uint64_t)i->anchors * sizeof(float));
  w += nmc__pad((uint64_t)i->dense * sizeof(float));
  w += nmc__pad((uint64_t)i->clips * i->targets);
  w += nmc__pad((uint64_t)i->slots * ((uint64_t)i->max_features + 1));
  w += nmc__pad((uint64_t)i->slots * 2);
  s += nmc__pad((uint64_t)i->slots * sizeof(double)) * 2;
  s += nmc__pad(((uint64_t)i->max_features + 2) * sizeof(double)) * 2;
  s += nmc__pad((nmc__inputs(i) + i->hidden0 + i->hidden1) * sizeof(double));
  i->workspace_bytes = nmc__size(w);
  i->scratch_bytes = nmc__size(s);
}

nmc_result nmc_read_info(const void *data, size_t size, nmc_info *info) {
  const uint8_t *bytes = (const uint8_t *)data;
  uint32_t at = 8, k;
  uint32_t *fields[13];
  uint64_t most;
  memset(info, 0, sizeof(*info));
  if (size < 4) return NMC_ERROR_TRUNCATED;
  if (bytes[0] != 'N' || bytes[1] != 'M' || bytes[2] != 'C') return NMC_ERROR_MAGIC;
  if (bytes[3] != NMC_VERSION) return NMC_ERROR_VERSION;
  if (size < 8) return NMC_ERROR_TRUNCATED;
  if (size >= 0x7fffffffu) return NMC_ERROR_LIMIT;
  fields[0] = &info->slots;
  fields[1] = &info->targets;
  fields[2] = &info->clips;
  fields[3] = &info->samples;
  fields[4] = &info->windows;
  fields[5] = &info->anchors;
  fields[6] = &info->weights;
  fields[7] = &info->atoms;
  fields[8] = &info->max_features;
  fields[9] = &info->dense;
  fields[10] = &info->hidden0;
  fields[11] = &info->hidden1;
  fields[12] = &info->max_frequencies;
  for (k = 0; k < 13; ++k) {
    nmc_result r;
    if (k >= 10 && info->dense == 0) break;
    r = nmc__varint(bytes, size, &at, fields[k]);
    if (r != NMC_OK) return r;
  }
  info->header_bytes = at;
  most = 64 * (uint64_t)size + 65536;
  if (info->slots > NMC__MAX_SLOTS || info->targets > info->slots || info->clips > NMC__MAX_CLIPS)
    return NMC_ERROR_LIMIT;
  if (info->samples > NMC__MAX_SAMPLES || info->windows > info->samples || info->max_features > NMC__MAX_FEATURES)
    return NMC_ERROR_LIMIT;
  if (info->weights > most || info->atoms > most || info->dense > most || info->windows > most) return NMC_ERROR_LIMIT;
  if (info->samples > 16 * most || info->anchors > 16 * most) return NMC_ERROR_LIMIT;
  if ((uint64_t)info->windows * info->targets > 64 * most) return NMC_ERROR_LIMIT;
  if ((uint64_t)info->slots * (info->max_features + 1) > 64 * most || (uint64_t)info->clips * info->targets > 64 * most)
    return NMC_ERROR_LIMIT;
  if (info->hidden0 > NMC__MAX_HIDDEN || info->hidden1 > NMC__MAX_HIDDEN || info->max_frequencies > NMC__MAX_FEATURES)
    return NMC_ERROR_LIMIT;
  nmc__measure(info);
  return NMC_OK;
}

static void *nmc__take(uint8_t **at, uint64_t bytes) {
  void *here = *at;
  *at += (size_t)nmc__pad(bytes);
  return here;
}

static nmc_result nmc__carve(nmc_set *set, void *workspace, size_t workspace_bytes) {
  const nmc_info *i = &set->info;
  uint8_t *at = (uint8_t *)workspace;
  if (workspace == NULL || workspace_bytes < i->workspace_bytes || ((uintptr_t)workspace & 7))
    return NMC_ERROR_ARGUMENT;
  memset(workspace, 0, i->workspace_bytes);
  set->models = (struct nmc_models *)nmc__take(&at, sizeof(struct nmc_models));
  set->clips = (nmc_clip *)nmc__take(&at, (uint64_t)i->clips * sizeof(nmc_clip));
  set->targets = (nmc_target *)nmc__take(&at, (uint64_t)i->targets * sizeof(nmc_target));
  set->step_exponents = (int32_t *)nmc__take(&at, (uint64_t)i->slots * sizeof(int32_t));
  set->levels = (int32_t *)nmc__take(&at, (uint64_t)i->slots * sizeof(int32_t));
  set->references = (float *)nmc__take(&at, (uint64_t)i->slots * sizeof(float));
  set->pose = (float *)nmc__take(&at, (uint64_t)i->slots * sizeof(float));
  set->windows = (nmc_window *)nmc__take(&at, (uint64_t)i->windows * sizeof(nmc_window));
  set->weights = (nmc_weight *)nmc__take(&at, (uint64_t)i->weights * sizeof(nmc_weight));
  set->atoms = (nmc_atom *)nmc__take(&at, (uint64_t)i->atoms * sizeof(nmc_atom));
  set->times = (float *)nmc__take(&at, (uint64_t)i->samples * sizeof(float));
  set->anchors = (float *)nmc__take(&at, (uint64_t)i->anchors * sizeof(float));
  set->dense = (float *)nmc__take(&at, (uint64_t)i->dense * sizeof(float));
  set->states = (uint8_t *)nmc__take(&at, (uint64_t)i->clips * i->targets);
  set->classes = (uint8_t *)nmc__take(&at, (uint64_t)i->slots * ((uint64_t)i->max_features + 1));
  set->lengths = (uint8_t *)nmc__take(&at, (uint64_t)i->slots * 2);
  return NMC_OK;
}

/* ---- Range coder and models ---- */

typedef struct nmc__coder {
  uint32_t low, high, code;
  const uint8_t *bytes;
  size_t size, at;
  uint64_t decisions, most_decisions;
  nmc_result result;
  struct nmc_models *models;
#ifdef NMC_ENCODER
  nmc_sink *sink; /* when writing */
  double *bits;   /* when reading, by part, of what is being read; may be NULL */
  int part;
#endif
} nmc__coder;

NMC__INLINE int nmc__squash(int32_t x) {
  static const uint16_t table[33] = {22,    36,    60,    98,    162,   267,   439,   720,   1179,  1921,  3108,
                                     4971,  7812,  11955, 17625, 24743, 32768, 40793, 47911, 53581, 57724, 60565,
                                     62428, 63615, 64357, 64816, 65097, 65269, 65374, 65438, 65476, 65500, 65514};
  const int32_t y = x < -2047 ? 1 : x > 2047 ? 4095 : x + 2048;
  return ((int)table[y >> 7] * (128 - (y & 127)) + (int)table[(y >> 7) + 1] * (y & 127)) >> 7;
}

static void nmc__start_models(struct nmc_models *m) {
  int32_t x;
  uint32_t i, next = 0;
  for (i = 0; i < sizeof(m->runs) / sizeof(m->runs[0]); ++i) m->runs[i].p = 32768;
  for (i = 0; i < NMC__MANTISSAS; ++i) m->mantissas[i].p = 32768;
  for (i = 0; i < sizeof(m->signs) / sizeof(m->signs[0]); ++i) m->signs[i].p = 32768;
  for (i = 0; i < sizeof(m->mixers) / sizeof(m->mixers[0]); ++i) m->mixers[i] = 20000;
  for (x = -2047; x <= 2047; ++x) {
    const uint32_t top = (uint32_t)nmc__squash(x) >> 4;
    for (; next <= top; ++next) m->stretch[next] = (int16_t)x;
  }
  for (; next < 4096; ++next) m->stretch[next] = 2047;
  for (i = 0; i < 64; ++i) m->rate[i] = (uint16_t)(65536 * 2 / (2 * i + 3));
}

static void nmc__fail(nmc__coder *c, nmc_result r) {
  if (c->result == NMC_OK) c->result = r;
}

/* Codes one binary decision whose probability of being 1 is p of 65536. Writing: takes `bit`; reading: returns it. */
NMC__INLINE int nmc__code(nmc__coder *c, int bit, uint32_t p) {
  const uint32_t range = c->high - c->low;
  const uint32_t middle = c->low + (range >> 16) * p + (((range & 0xffffu) * p) >> 16);
  uint32_t mask;
#ifdef NMC_ENCODER
  if (c->sink) {
    c->sink->bits[c->part] -= log2((bit ? p : 65536.0 - p) / 65536.0);
    ++c->sink->decisions;
    if (!c->sink->put) return bit;
  } else
#endif
    bit = c->code <= middle;
#ifdef NMC_ENCODER
  if (c->bits) c->bits[c->part] -= log2((bit ? p : 65536.0 - p) / 65536.0);
#endif
  mask = 0u - (uint32_t)bit; /* no branch on what no processor can foresee */
  c->high = (middle & mask) | (c->high & ~mask);
  c->low = (c->low & mask) | ((middle + 1) & ~mask);
  while (((c->low ^ c->high) & 0xff000000u) == 0) {
    const uint8_t top = (uint8_t)(c->high >> 24);
    c->low <<= 8;
    c->high = (c->high << 8) | 255u;
#ifdef NMC_ENCODER
    if (c->sink) {
      c->sink->put(c->sink->user, top);
      continue;
    }
#else
    (void)top;
#endif
    c->code = (c->code << 8) | (c->at < c->size ? c->bytes[c->at] : 0u);
    ++c->at;
  }
  if (++c->decisions > c->most_decisions || c->at > c->size + 4) nmc__fail(c, NMC_ERROR_TRUNCATED);
  return bit;
}

/* Without branches on the bit, which no processor can foresee. */
NMC__INLINE void nmc__learn(const struct nmc_models *m, nmc__bit_model *b, int bit, uint32_t limit) {
  const uint32_t zero = (uint32_t)bit - 1u; /* all bits set for a 0 */
  const uint32_t p = b->p, n = b->n;
  const uint32_t part = ((p ^ (~zero & 65535u)) * m->rate[n]) >> 16; /* of the way to 65535, or to 0 */
  const uint32_t q = p + (part ^ zero) - zero;
  b->p = (uint16_t)(q < 32 ? 32 : q > 65503 ? 65503 : q);
  b->n = (uint16_t)(n + (n < limit));
}

static int nmc__code_simple(nmc__coder *c, nmc__bit_model *b, int bit) {
  bit = nmc__code(c, bit, b->p);
  nmc__learn(c->models, b, bit, 30);
  return bit;
}

/* A decision predicted by several models, mixed in the logistic domain by learned weights. */
static int nmc__code_mixed(nmc__coder *c, nmc__bit_model *const *models, int count, int32_t *weights, int bit) {
  int32_t s[NMC__INPUTS];
  int64_t dot = 0;
  int32_t p, error;
  int i;
  for (i = 0; i < count; ++i) {
    s[i] = c->models->stretch[models[i]->p >> 4];
    dot += (int64_t)weights[i] * s[i];
  }
  dot >>= 16;
  p = nmc__squash(dot < -2047 ? -2047 : dot > 2047 ? 2047 : (int32_t)dot);
  if (p < 32) p = 32;
  if (p > 65504) p = 65504;
  bit = nmc__code(c, bit, (uint32_t)p);
  error = ((bit << 16) - p) * 6;
  for (i = 0; i < count; ++i) {
    weights[i] += (s[i] * error + 0x80000) >> 20;
    nmc__learn(c->models, models[i], bit, 60);
  }
  return bit;
}

static uint32_t nmc__raw(nmc__coder *c, uint32_t value, int bits) {
  uint32_t v = 0;
  int i;
  for (i = bits - 1; i >= 0; --i) v = (v << 1) | (uint32_t)nmc__code(c, (int)((value >> i) & 1u), 32768);
  return v;
}

static float nmc__raw_float(nmc__coder *c, float value) {
  uint32_t u;
  memcpy(&u, &value, 4);
  u = nmc__raw(c, u, 32);
  memcpy(&value, &u, 4);
  if (((u >> 23) & 255u) == 255u) nmc__fail(c, NMC_ERROR_CORRUPT); /* not finite */
  return value;
}

static uint32_t nmc__bit_length(uint32_t v) {
  uint32_t n = 0;
  for (; v; v >>= 1) ++n;
  return n;
}

static uint32_t nmc__least(uint32_t a, uint32_t b) { return a < b ? a : b; }

/* An unsigned number: its bit length in unary, by mixed models (runs[i] is input i's run), then its bits below the
 * first. */
static uint32_t nmc__number(nmc__coder *c, int group, const uint32_t *runs, int count, uint32_t most_bits,
                            uint32_t value) {
  struct nmc_models *m = c->models;
  const uint32_t length = nmc__bit_length(value);
  uint32_t k, v;
  int i;
  for (k = 0; k < most_bits; ++k) {
    nmc__bit_model *inputs[NMC__INPUTS];
    const uint32_t level = nmc__least(k, NMC__LEVELS - 1);
    int more;
    for (i = 0; i < count; ++i) inputs[i] = &m->runs[runs[i] * NMC__LEVELS + level];
    more = count == 1 ? nmc__code_simple(c, inputs[0], length > k)
                      : nmc__code_mixed(c, inputs, count,
                                        &m->mixers[((uint32_t)group * NMC__LEVELS + level) * NMC__INPUTS], length > k);
    if (!more || c->result != NMC_OK) break;
  }
  if (k < 2) return k;
  v = 1;
  for (i = (int)k - 2; i >= 0; --i) {
    const int depth = (int)k - 2 - i;
    const int bit = (int)((value >> i) & 1u);
    if (depth == 0)
      v = (v << 1) | (uint32_t)nmc__code_simple(c, &m->mantissas[((uint32_t)group * 32 + k - 1) * 4], bit);
    else if (depth == 1)
      v = (v << 1) |
          (uint32_t)nmc__code_simple(c, &m->mantissas[((uint32_t)group * 32 + k - 1) * 4 + 1 + (v & 1u)], bit);
    else
      v = (v << 1) | (uint32_t)nmc__code(c, bit, 32768);
  }
  return v;
}

static int32_t nmc__signed_number(nmc__coder *c, int group, const uint32_t *runs, int count, uint32_t sign_context,
                                  int32_t value) {
  const uint32_t size = nmc__number(c, group, runs, count, NMC__LEVEL_BITS, (uint32_t)(value < 0 ? -value : value));
  if (size == 0) return 0;
  return nmc__code_simple(c, &c->models->signs[(uint32_t)group * 9 + sign_context], value < 0) ? -(int32_t)size
                                                                                               : (int32_t)size;
}

static uint32_t nmc__simple(nmc__coder *c, uint32_t context, uint32_t value) {
  const uint32_t run = NMC__SIMPLE + context;
  return nmc__number(c, 5, &run, 1, 32, value);
}

static int32_t nmc__simple_signed(nmc__coder *c, uint32_t context, int32_t value) {
  const uint32_t z = nmc__simple(c, context, value < 0 ? 2u * (uint32_t)(-(value + 1)) + 1u : 2u * (uint32_t)value);
  return z & 1u ? -(int32_t)(z >> 1) - 1 : (int32_t)(z >> 1);
}

static int nmc__flag(nmc__coder *c, int value) { return nmc__simple(c, NMC__S_FLAG, value ? 1u : 0u) != 0; }

/* ---- Steps ---- */

static double nmc__slot_step(const nmc_set *set, uint32_t slot) {
  return set->base_step * nmc__power(2 * set->step_exponents[slot]);
}

static double nmc__anchor_step(const nmc_set *set, uint32_t slot) {
  return nmc__slot_step(set, slot) * nmc__power(set->anchor_exponent);
}

static double nmc__weight_step(const nmc_set *set, const nmc_clip *clip, uint32_t slot, uint32_t length) {
  return nmc__slot_step(set, slot) * nmc__power(clip->step_exponent) * NMC_SQRT(2.0 / length);
}

/* ---- The payload: one routine reads it and (for the encoder) writes it ---- */

static uint32_t nmc__parameters(const nmc_target *t, int state) {
  if (state == NMC_ABSENT) return 0;
  return t->path == NMC_ROTATION && state != NMC_QUATERNION ? 3 : t->width;
}

static void nmc__part(nmc__coder *c, int part) {
#ifdef NMC_ENCODER
  c->part = part;
#else
  (void)c;
  (void)part;
#endif
}

enum { NMC__HEADER, NMC__REFERENCES, NMC__TIMES, NMC__STATES, NMC__ANCHORS, NMC__WEIGHTS, NMC__ATOMS, NMC__NETWORK };

static void nmc__code_targets(nmc__coder *c, nmc_set *set) {
  uint32_t t, a, offset = 0;
  int32_t before = 0;
  nmc__part(c, NMC__HEADER);
  set->exact_references = (uint8_t)nmc__raw(c, set->exact_references, 1);
  set->has_network = (uint8_t)nmc__raw(c, set->has_network, 1);
  set->quantized_network = (uint8_t)nmc__raw(c, set->quantized_network, 1);
  if (set->has_network != (set->info.dense > 0)) nmc__fail(c, NMC_ERROR_CORRUPT);
  set->base_step = nmc__raw_float(c, set->base_step);
  set->anchor_exponent = nmc__simple_signed(c, NMC__S_CLIP_EXPONENT, set->anchor_exponent);
  if (set->anchor_exponent < -255 || set->anchor_exponent > 255) nmc__fail(c, NMC_ERROR_CORRUPT);
  for (t = 0; t < set->info.targets && c->result == NMC_OK; ++t) {
    nmc_target *target = &set->targets[t];
    target->path = (uint8_t)nmc__simple(c, NMC__S_STATE + (t ? 4u + set->targets[t - 1].path : 0u), target->path);
    if (target->path > NMC_WEIGHTS) {
      nmc__fail(c, NMC_ERROR_CORRUPT);
      return;
    }
    if (target->path == NMC_WEIGHTS) {
      const uint32_t width = nmc__simple(c, NMC__S_COUNT, target->width);
      if (width > NMC__MAX_SLOTS) {
        nmc__fail(c, NMC_ERROR_CORRUPT);
        return;
      }
      target->width = (uint16_t)width;
    } else {
      target->width = target->path == NMC_ROTATION ? 4 : 3;
    }
    target->offset = offset;
    if (target->width == 0 || offset + target->width > set->info.slots) {
      nmc__fail(c, NMC_ERROR_CORRUPT);
      return;
    }
    nmc__part(c, NMC__REFERENCES);
    for (a = 0; a < target->width; ++a) {
      const uint32_t run = NMC__REFERENCE_A + 12 * (uint32_t)target->path + nmc__least(a, 3);
      int32_t *e = &set->step_exponents[offset + a];
      if (!set->exact_references) {
        if (target->path == NMC_ROTATION && a == 3) {
          *e = before;
        } else {
          const uint32_t context = NMC__S_STATE + 16 + 4 * (uint32_t)target->path + nmc__least(a, 3);
          const int64_t exponent = before + (int64_t)nmc__simple_signed(c, context, *e - before);
          if (exponent < -127 || exponent > 127) {
            nmc__fail(c, NMC_ERROR_CORRUPT);
            return;
          }
          *e = before = (int32_t)exponent;
        }
        if (target->path == NMC_ROTATION && a == 3) continue;
        set->references[offset + a] = (float)nmc__signed_number(c, 3, &run, 1, 0, (int32_t)set->references[offset + a]);
      } else {
        set->references[offset + a] = nmc__raw_float(c, set->references[offset + a]);
      }
    }
    nmc__part(c, NMC__HEADER);
    offset += target->width;
  }
  if (offset != set->info.slots) nmc__fail(c, NMC_ERROR_CORRUPT);
}

/* The formulas of key times. 0: (first + n) / rate, in double; 1: float(first + n) * step, in float; 2: start + n *
 * step, in double; 3: the previous time + step, in float. */
static float nmc__formula_time(const nmc_clip *clip, uint32_t n, float previous) {
  switch (clip->time_mode) {
    case 0:
      return (float)(((double)clip->time_first + n) / clip->time_rate);
    case 1: {
      volatile float product =
          (float)((double)clip->time_first + n) * (float)clip->time_step; /* volatile: no wider intermediate */
      return product;
    }
    case 2: {
      volatile double product = n * clip->time_step; /* volatile: no fused multiply-add */
      return (float)((double)clip->time_start + product);
    }
    default: {
      volatile float sum = n == 0 ? clip->time_start : previous + (float)clip->time_step;
      return sum;
    }
  }
}

static int32_t nmc__float_order(float x) {
  int32_t i;
  memcpy(&i, &x, 4);
  return i < 0 ? (int32_t)(0x80000000u - (uint32_t)i) : i;
}

static float nmc__float_of_order(int64_t order) {
  uint32_t u = order < 0 ? 0x80000000u | (uint32_t)(-order) : (uint32_t)order;
  float x;
  memcpy(&x, &u, 4);
  return x;
}

static void nmc__code_times(nmc__coder *c, nmc_set *set, nmc_clip *clip, const nmc_clip *before) {
  float *times = set->times + clip->first_time;
  float previous = 0;
  uint32_t n;
  int same;
  nmc__part(c, NMC__TIMES);
  same = before && before->time_mode == clip->time_mode && before->time_rate == clip->time_rate &&
         before->time_step == clip->time_step && before->time_start == clip->time_start &&
         before->time_first == clip->time_first;
  if (before) same = nmc__flag(c, same);
  if (same) {
    clip->time_mode = before->time_mode;
    clip->time_first = before->time_first;
    clip->time_rate = before->time_rate;
    clip->time_start = before->time_start;
    clip->time_step = before->time_step;
  } else {
    clip->time_mode = (uint8_t)nmc__raw(c, clip->time_mode, 2);
    if (clip->time_mode < 2)
      clip->time_first = nmc__simple_signed(c, NMC__S_TIME, clip->time_first);
    else
      clip->time_start = nmc__raw_float(c, clip->time_start);
    if (clip->time_mode == 0) {
      clip->time_rate = nmc__simple(c, NMC__S_TIME, clip->time_rate);
      if (clip->time_rate == 0) nmc__fail(c, NMC_ERROR_CORRUPT);
    } else if (clip->time_mode == 2) {
      uint64_t u;
      memcpy(&u, &clip->time_step, 8);
      u = (uint64_t)nmc__raw(c, (uint32_t)(u >> 32), 32) << 32 | nmc__raw(c, (uint32_t)u, 32);
      memcpy(&clip->time_step, &u, 8);
      if (((u >> 52) & 2047u) == 2047u) nmc__fail(c, NMC_ERROR_CORRUPT);
    } else {
      clip->time_step = nmc__raw_float(c, (float)clip->time_step);
    }
  }
  clip->time_exact = (uint8_t)nmc__flag(c, clip->time_exact);
  for (n = 0; n < clip->samples && c->result == NMC_OK; ++n) {
    const float formula = nmc__formula_time(clip, n, previous);
    if (clip->time_exact) {
      times[n] = formula;
    } else {
      const int64_t base = nmc__float_order(formula);
      const int64_t off = nmc__simple_signed(c, NMC__S_TIME_ERROR, (int32_t)(nmc__float_order(times[n]) - base));
      if (base + off > 0x7f7fffff || base + off < -0x7f7fffff) {
        nmc__fail(c, NMC_ERROR_CORRUPT);
        return;
      }
      times[n] = nmc__float_of_order(base + off);
    }
    if (!(times[n] - times[n] == 0) || (n && !(times[n] > previous))) nmc__fail(c, NMC_ERROR_CORRUPT);
    previous = times[n];
  }
}

static void nmc__code_windows(nmc__coder *c, nmc_set *set, nmc_clip *clip) {
  uint32_t k, begin = 0;
  nmc__part(c, NMC__STATES);
  clip->basis = (uint8_t)nmc__simple(c, NMC__S_STATE + 12, clip->basis);
  if (clip->basis > NMC_SINE || (clip->basis != NMC_COSINE && clip->samples < 2)) {
    nmc__fail(c, NMC_ERROR_CORRUPT);
    return;
  }
  if (clip->basis == NMC_SINE)
    clip->windows = nmc__simple(c, NMC__S_COUNT, clip->windows);
  else
    clip->windows = 1;
  if (clip->windows == 0 || clip->windows >= clip->samples + (clip->samples == 1) ||
      clip->windows > set->info.windows - clip->first_window) {
    nmc__fail(c, NMC_ERROR_CORRUPT);
    return;
  }
  clip->anchor_rows = clip->basis == NMC_COSINE ? 1 : clip->windows + 1;
  clip->even_windows = 1;
  if (clip->windows > 1) {
    int even = 1;
    for (k = 0; k < clip->windows; ++k)
      even = even && set->windows[clip->first_window + k].begin ==
                         (uint32_t)((uint64_t)k * (clip->samples - 1) / clip->windows);
    clip->even_windows = (uint8_t)nmc__flag(c, even);
  }
  for (k = 0; k < clip->windows && c->result == NMC_OK; ++k) {
    nmc_window *w = &set->windows[clip->first_window + k];
    const uint32_t last = clip->samples - 1;
    w->begin = begin;
    if (k + 1 == clip->windows)
      w->length = clip->basis == NMC_COSINE ? clip->samples : last - begin;
    else if (clip->even_windows)
      w->length = (uint32_t)((uint64_t)(k + 1) * last / clip->windows) - begin;
    else
      w->length = nmc__simple(c, NMC__S_COUNT, w->length);
    if (w->length == 0 || (k + 1 < clip->windows && w->length >= last - begin)) {
      nmc__fail(c, NMC_ERROR_CORRUPT);
      return;
    }
    begin += w->length;
  }
}

static void nmc__code_states(nmc__coder *c, nmc_set *set, uint32_t index) {
  nmc_clip *clip = &set->clips[index];
  const uint32_t targets = set->info.targets;
  uint8_t *states = set->states + (size_t)index * targets;
  uint32_t t, parameters = 0, outputs = 0;
  for (t = 0; t < targets && c->result == NMC_OK; ++t) {
    const uint32_t before = index ? states[(ptrdiff_t)t - (ptrdiff_t)targets] : 0u;
    const uint32_t last = t ? states[t - 1] : 0u;
    const uint32_t context = 40 + (index ? before : 4u) * 4 + last;
    const uint32_t state = nmc__simple(c, NMC__S_STATE + context, states[t]);
    if (state > NMC_QUATERNION || (state == NMC_QUATERNION && set->targets[t].path != NMC_ROTATION)) {
      nmc__fail(c, NMC_ERROR_CORRUPT);
      return;
    }
    states[t] = (uint8_t)state;
    parameters += nmc__parameters(&set->targets[t], (int)state);
    if (state >= NMC_MOVING) outputs += nmc__parameters(&set->targets[t], (int)state);
  }
  clip->parameters = parameters;
  clip->outputs = outputs;
}

/* Puts the last anchor pose of `clip` into set->levels, by slots; targets it lacks are 0. */
static void nmc__recall(nmc_set *set, int32_t index) {
  const uint8_t *states;
  const float *row;
  uint32_t t, a;
  memset(set->levels, 0, (size_t)set->info.slots * sizeof(int32_t));
  if (index < 0) return;
  states = set->states + (size_t)index * set->info.targets;
  row = set->anchors + set->clips[index].first_anchor +
        (size_t)(set->clips[index].anchor_rows - 1) * set->clips[index].parameters;
  for (t = 0; t < set->info.targets; ++t) {
    const uint32_t n = nmc__parameters(&set->targets[t], states[t]);
    if (states[t] != NMC_QUATERNION)
      for (a = 0; a < n; ++a) set->levels[set->targets[t].offset + a] = (int32_t)row[a];
    row += n;
  }
}

static void nmc__code_anchors(nmc__coder *c, nmc_set *set, uint32_t index) {
  nmc_clip *clip = &set->clips[index];
  const uint8_t *states = set->states + (size_t)index * set->info.targets;
  uint32_t r, t, a, back;
  nmc__part(c, NMC__ANCHORS);
  back = nmc__simple(c, NMC__S_REFERENCE, (uint32_t)((int64_t)index - clip->reference - 1));
  if (back > index) {
    nmc__fail(c, NMC_ERROR_CORRUPT);
    return;
  }
  clip->reference = (int32_t)(index - back) - 1;
  if ((uint64_t)clip->anchor_rows * clip->parameters > set->info.anchors - clip->first_anchor) {
    nmc__fail(c, NMC_ERROR_CORRUPT);
    return;
  }
  nmc__recall(set, clip->reference);
  for (r = 0; r < clip->anchor_rows && c->result == NMC_OK; ++r) {
    float *row = set->anchors + clip->first_anchor + (size_t)r * clip->parameters;
    for (t = 0; t < set->info.targets && c->result == NMC_OK; ++t) {
      const nmc_target *target = &set->targets[t];
      const uint32_t n = nmc__parameters(target, states[t]);
      uint32_t near[2] = {0, 0};
      for (a = 0; a < n; ++a) {
        const uint32_t slot = target->offset + a;
        const int32_t guess = r == 0 && states[t] == NMC_QUATERNION ? 0 : set->levels[slot];
        uint8_t *was = &set->lengths[set->info.slots + slot];
        uint32_t runs[3], kind, length;
        int32_t difference = 0;
        if (r == 0 || states[t] >= NMC_MOVING) {
          kind = r > 0 ? 2u : states[t] == NMC_STATIC ? 0u : 1u;
          runs[0] = NMC__ANCHOR_A + ((nmc__least(*was, 11) * 3 + nmc__least(a, 2)) * 4 + target->path) * 3 + kind;
          runs[1] = NMC__ANCHOR_B + (nmc__least(near[0], 11) * 12 + nmc__least(near[1], 11)) * 3 + kind;
          runs[2] = NMC__ANCHOR_C + (slot & 511u);
          difference = nmc__signed_number(c, 2, runs, 3, kind, (int32_t)row[a] - guess);
          length = nmc__bit_length((uint32_t)(difference < 0 ? -difference : difference));
          *was = (uint8_t)length;
          near[1] = near[0];
          near[0] = length;
        }
        if (guess + difference >= 1 << NMC__LEVEL_BITS || guess + difference <= -(1 << NMC__LEVEL_BITS)) {
          nmc__fail(c, NMC_ERROR_CORRUPT);
          return;
        }
        row[a] = (float)(guess + difference);
        set->levels[slot] = guess + difference;
      }
      row += n;
    }
  }
}

/* The bit length of the last level at (about) the same frequency, and of its neighbours, as one small number. */
static uint32_t nmc__around(const uint8_t *classes, uint32_t j, uint32_t last) {
  const uint32_t sum = (j > 0 ? classes[j - 1] : 0u) + 2u * classes[j] + (j < last ? classes[j + 1] : 0u);
  return sum < 8 ? sum : nmc__least(8 + (sum - 8) / 4, 15);
}

static uint32_t nmc__around8(const uint8_t *classes, uint32_t j, uint32_t last) {
  const uint32_t around = nmc__around(classes, j, last);
  return around < 5 ? around : around < 8 ? 5u : around < 11 ? 6u : 7u;
}

static uint32_t nmc__band(uint32_t j) {
  return j < 4 ? j - 1 : j < 6 ? 3u : j < 10 ? 4u : j < 18 ? 5u : j < 40 ? 6u : 7u;
}

/* The weights of one parameter in one window. `levels` (from 1 to count) are in the set's records. */
static void nmc__code_row(nmc__coder *c, nmc_set *set, nmc_window *w, uint32_t parameter, uint32_t slot,
                          uint32_t target, uint32_t axis, uint32_t same, uint32_t *next, uint32_t end) {
  const uint32_t most = set->info.max_features, stride = most + 1;
  uint8_t *row = set->classes + (size_t)slot * stride;
  const uint8_t *near1 = axis > 0 ? row - stride : NULL, *near2 = axis > 1 ? row - 2 * (size_t)stride : NULL;
  const uint8_t *other = same != UINT32_MAX ? set->classes + (size_t)same * stride : NULL;
  const uint32_t path = set->targets[target].path;
  uint32_t runs[NMC__INPUTS], count = 0, j, one = 0, two = 0;
  uint8_t *length = &set->lengths[slot];
  const uint32_t stale = nmc__least((1u << *length) - 1u, most);
#ifdef NMC_ENCODER
  uint32_t k;
  if (c->sink)
    for (k = *next; k < end && set->weights[k].parameter == parameter; ++k) count = set->weights[k].feature;
#endif
  runs[0] = NMC__COUNT_A + nmc__least(*length, 11) * 12 + nmc__least(axis > 0 ? set->lengths[slot - 1] : 11u, 11);
  runs[1] =
      NMC__COUNT_B + (nmc__least(axis > 1 ? set->lengths[slot - 2] : 11u, 11) * 3 + nmc__least(axis, 2)) * 4 + path;
  runs[2] = NMC__COUNT_C + (slot & 511u);
  count = nmc__number(c, 1, runs, 3, 17, count);
  if (count > most) {
    nmc__fail(c, NMC_ERROR_CORRUPT);
    return;
  }
  *length = (uint8_t)nmc__bit_length(count);
  if (count > w->features) w->features = count;
  for (j = 1; j <= count && c->result == NMC_OK; ++j) {
    const uint32_t band = nmc__band(j);
    const uint32_t n1 = near1 ? nmc__around8(near1, j, most) : 0u, n2 = near2 ? nmc__around8(near2, j, most) : 0u;
    const uint32_t past = nmc__around(row, j, most);
    const uint32_t parent = other ? nmc__around8(other, j, most) : 0u;
    const uint32_t left = nmc__least(count - j, 7);
    int32_t level = *next < end && set->weights[*next].parameter == parameter && set->weights[*next].feature == j
                        ? (int32_t)set->weights[*next].value
                        : 0;
    runs[0] = NMC__WEIGHT_A + (nmc__least(one, 7) * 8 + nmc__least(two, 7)) * 8 + band;
    runs[1] = NMC__WEIGHT_B + (n1 * 8 + n2) * 3 + nmc__least(axis, 2);
    runs[2] = NMC__WEIGHT_C + past * 8 + band;
    runs[3] = NMC__WEIGHT_D + (slot & 511u) * 4 + band / 2;
    runs[4] = NMC__WEIGHT_E + (parent * 8 + left) * 8 + nmc__least(one + two, 7);
    runs[5] = NMC__WEIGHT_F + nmc__least(j, 63) * 4 + path;
    level = nmc__signed_number(c, 0, runs, NMC__INPUTS, 0, level);
    two = one;
    one = nmc__bit_length((uint32_t)(level < 0 ? -level : level));
    if (j > 1) row[j - 1] = (uint8_t)two;
    if (level == 0) {
      if (j == count) nmc__fail(c, NMC_ERROR_CORRUPT);
      continue;
    }
    if (*next >= end) {
      nmc__fail(c, NMC_ERROR_CORRUPT);
      return;
    }
    set->weights[*next].feature = (uint16_t)j;
    set->weights[*next].parameter = (uint16_t)parameter;
    set->weights[*next].value = (float)level;
    ++*next;
  }
  if (count) row[count] = (uint8_t)one;
  for (j = count + 1; j <= stale; ++j) row[j] = 0;
}

static void nmc__code_weights(nmc__coder *c, nmc_set *set, uint32_t index, uint32_t *next) {
  nmc_clip *clip = &set->clips[index];
  const uint8_t *states = set->states + (size_t)index * set->info.targets;
  uint32_t k, t, a;
  nmc__part(c, NMC__WEIGHTS);
  clip->step_exponent = nmc__simple_signed(c, NMC__S_CLIP_EXPONENT, clip->step_exponent);
  if (clip->step_exponent < -255 || clip->step_exponent > 255) nmc__fail(c, NMC_ERROR_CORRUPT);
  if (set->info.max_features == 0) return;
  for (k = 0; k < clip->windows && c->result == NMC_OK; ++k) {
    nmc_window *w = &set->windows[clip->first_window + k];
    uint32_t parameter = 0, last_slot[4] = {UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX};
    uint32_t end = set->info.weights;
#ifdef NMC_ENCODER
    if (c->sink) end = w->first_weight + w->weights;
#endif
    w->first_weight = *next;
    w->features = 0;
    for (t = 0; t < set->info.targets && c->result == NMC_OK; ++t) {
      const nmc_target *target = &set->targets[t];
      const uint32_t n = nmc__parameters(target, states[t]);
      if (states[t] >= NMC_MOVING) {
        for (a = 0; a < n && c->result == NMC_OK; ++a) {
          const uint32_t same =
              last_slot[target->path] == UINT32_MAX ? UINT32_MAX : last_slot[target->path] + nmc__least(a, 2);
          nmc__code_row(c, set, w, parameter + a, target->offset + a, t, a,
                        target->path == NMC_WEIGHTS ? UINT32_MAX : same, next, end);
        }
        last_slot[target->path] = target->offset;
      }
      parameter += n;
    }
    w->weights = *next - w->first_weight;
  }
}

/* set->levels, which only anchors need, says of each of the clip's parameters whether it moves. */
static void nmc__mark_moving(nmc_set *set, uint32_t index) {
  const uint8_t *states = set->states + (size_t)index * set->info.targets;
  uint32_t t, a, parameter = 0;
  for (t = 0; t < set->info.targets; ++t)
    for (a = nmc__parameters(&set->targets[t], states[t]); a > 0; --a)
      set->levels[parameter++] = states[t] >= NMC_MOVING;
}

static void nmc__code_atoms(nmc__coder *c, nmc_set *set, uint32_t index, uint32_t *next) {
  nmc_clip *clip = &set->clips[index];
  uint32_t i, sample = 0;
  nmc__part(c, NMC__ATOMS);
  clip->atoms = nmc__simple(c, NMC__S_REFERENCE + 0, clip->atoms);
  if (clip->atoms > set->info.atoms - *next) {
    nmc__fail(c, NMC_ERROR_CORRUPT);
    return;
  }
  clip->first_atom = *next;
  if (clip->atoms > 0) nmc__mark_moving(set, index);
  for (i = 0; i < clip->atoms && c->result == NMC_OK; ++i) {
    nmc_atom *atom = &set->atoms[clip->first_atom + i];
    uint32_t parameter, width;
    int32_t level;
    const uint32_t gap = nmc__simple(c, NMC__S_ATOM_GAP, atom->sample - sample);
    if (gap >= clip->samples) {
      nmc__fail(c, NMC_ERROR_CORRUPT);
      return;
    }
    sample += gap;
    parameter = nmc__simple(c, NMC__S_ATOM_PARAMETER, atom->parameter);
    width = nmc__simple(c, NMC__S_ATOM_WIDTH, atom->width);
    level = nmc__simple_signed(c, NMC__S_ATOM_VALUE, (int32_t)atom->value);
    if (sample >= clip->samples || parameter >= clip->parameters || !set->levels[parameter] ||
        (width == NMC_JUMP ? sample == 0 : width > 15) || level >= 1 << NMC__LEVEL_BITS ||
        level <= -(1 << NMC__LEVEL_BITS)) {
      nmc__fail(c, NMC_ERROR_CORRUPT);
      return;
    }
    atom->sample = sample;
    atom->parameter = (uint16_t)parameter;
    atom->width = (uint16_t)width;
    atom->value = (float)level;
  }
  *next += clip->atoms;
}

/* A network tensor of rows x columns, column by column: float32, or a step and whole levels. */
static void nmc__code_tensor(nmc__coder *c, nmc_set *set, float *values, uint32_t rows, uint32_t columns,
                             uint32_t kind) {
  const uint64_t count = (uint64_t)rows * columns;
  uint64_t i;
  float step = 1;
  if (!set->quantized_network) {
    for (i = 0; i < count && c->result == NMC_OK; ++i) values[i] = nmc__raw_float(c, values[i]);
    return;
  }
  /* An encoder puts the step in front of the levels: the array has one more place. */
  step = nmc__raw_float(c, values[count]);
  values[count] = step;
  for (i = 0; i < count && c->result == NMC_OK; ++i) {
    uint32_t runs[2];
    const float above = i % rows ? values[i - 1] : 0, left = i >= rows ? values[i - rows] : 0;
    const uint32_t m0 = nmc__bit_length((uint32_t)(above < 0 ? -above : above)),
                   m1 = nmc__bit_length((uint32_t)(left < 0 ? -left : left));
    runs[0] = NMC__TENSOR_A + (nmc__least(m0, 11) * 12 + nmc__least(m1, 11)) * 6 + kind;
    runs[1] = NMC__TENSOR_B + nmc__least((m0 + m1) / 2, 11) * 6 + kind;
    values[i] = (float)nmc__signed_number(c, 4, runs, 2, 0, (int32_t)values[i]);
  }
}

static uint64_t nmc__tensor_size(const nmc_set *set, uint64_t rows, uint64_t columns) {
  return rows * columns + (set->quantized_network ? 1u : 0u);
}

static void nmc__code_clip_layer(nmc__coder *c, nmc_set *set, nmc_clip *clip, uint64_t *at) {
  const uint32_t h = set->info.hidden0;
  uint64_t inputs, size;
  uint32_t k, before = 0;
  nmc__part(c, NMC__NETWORK);
  clip->frequencies = nmc__simple(c, NMC__S_COUNT, clip->frequencies);
  if (clip->frequencies > set->info.max_frequencies) {
    nmc__fail(c, NMC_ERROR_CORRUPT);
    return;
  }
  inputs = 2 * (uint64_t)clip->frequencies + 1;
  size = clip->frequencies + nmc__tensor_size(set, h, inputs) + nmc__tensor_size(set, h, 1);
  if (size > set->info.dense - *at) {
    nmc__fail(c, NMC_ERROR_CORRUPT);
    return;
  }
  clip->first_dense = (uint32_t)*at;
  for (k = 0; k < clip->frequencies; ++k) { /* in the order in which Algorithm 1 found them */
    float *f = &set->dense[*at + k];
    before = nmc__simple(c, NMC__S_FREQUENCY, (uint32_t)*f);
    if (before > NMC__MAX_FEATURES) nmc__fail(c, NMC_ERROR_CORRUPT);
    *f = (float)before;
  }
  nmc__code_tensor(c, set, set->dense + *at + clip->frequencies, h, (uint32_t)inputs, 0);
  nmc__code_tensor(c, set, set->dense + *at + clip->frequencies + nmc__tensor_size(set, h, inputs), h, 1, 1);
  *at += size;
}

static void nmc__code_shared(nmc__coder *c, nmc_set *set, uint64_t *at) {
  const uint32_t h0 = set->info.hidden0, h1 = set->info.hidden1;
  uint64_t size;
  uint32_t k;
  nmc__part(c, NMC__NETWORK);
  set->outputs = nmc__simple(c, NMC__S_COUNT, set->outputs);
  if (set->outputs > NMC__MAX_SLOTS) {
    nmc__fail(c, NMC_ERROR_CORRUPT);
    return;
  }
  for (k = 0; k < set->info.clips; ++k)
    if (set->clips[k].outputs != set->outputs) nmc__fail(c, NMC_ERROR_CORRUPT);
  size = nmc__tensor_size(set, h1, h0) + nmc__tensor_size(set, h1, 1) + nmc__tensor_size(set, set->outputs, h1) +
         nmc__tensor_size(set, set->outputs, 1);
  if (size != set->info.dense - *at) nmc__fail(c, NMC_ERROR_CORRUPT);
  if (c->result != NMC_OK) return;
  set->first_shared = (uint32_t)*at;
  nmc__code_tensor(c, set, set->dense + *at, h1, h0, 2);
  *at += nmc__tensor_size(set, h1, h0);
  nmc__code_tensor(c, set, set->dense + *at, h1, 1, 3);
  *at += nmc__tensor_size(set, h1, 1);
  nmc__code_tensor(c, set, set->dense + *at, set->outputs, h1, 4);
  *at += nmc__tensor_size(set, set->outputs, h1);
  nmc__code_tensor(c, set, set->dense + *at, set->outputs, 1, 5);
  *at += nmc__tensor_size(set, set->outputs, 1);
}

static void nmc__code_payload(nmc__coder *c, nmc_set *set) {
  uint32_t k, time = 0, window = 0, anchor = 0, weight = 0, atom = 0;
  uint64_t dense = 0;
  nmc__start_models(set->models);
  memset(set->classes, 0, (size_t)set->info.slots * ((size_t)set->info.max_features + 1));
  memset(set->lengths, 0, (size_t)set->info.slots * 2);
  nmc__code_targets(c, set);
  for (k = 0; k < set->info.clips && c->result == NMC_OK; ++k) {
    nmc_clip *clip = &set->clips[k];
#ifdef NMC_ENCODER
    if (c->bits) c->bits += NMC_PARTS;
#endif
    nmc__part(c, NMC__TIMES);
    clip->samples = nmc__simple(c, NMC__S_COUNT, clip->samples);
    if (clip->samples == 0 || clip->samples > set->info.samples - time) {
      nmc__fail(c, NMC_ERROR_CORRUPT);
      return;
    }
    clip->first_time = time;
    clip->first_window = window;
    clip->first_anchor = anchor;
    nmc__code_times(c, set, clip, k ? clip - 1 : NULL);
    if (c->result == NMC_OK) nmc__code_windows(c, set, clip);
    if (c->result == NMC_OK) nmc__code_states(c, set, k);
    if (c->result == NMC_OK) nmc__code_anchors(c, set, k);
    if (c->result == NMC_OK) nmc__code_weights(c, set, k, &weight);
    if (c->result == NMC_OK) nmc__code_atoms(c, set, k, &atom);
    if (c->result == NMC_OK && set->has_network) nmc__code_clip_layer(c, set, clip, &dense);
    time += clip->samples;
    window += clip->windows;
    anchor += clip->anchor_rows * clip->parameters;
  }
#ifdef NMC_ENCODER
  if (c->bits) c->bits -= (size_t)NMC_PARTS * k;
#endif
  if (c->result == NMC_OK && set->has_network) nmc__code_shared(c, set, &dense);
  if (c->result != NMC_OK) return;
  if (time != set->info.samples || window != set->info.windows || anchor != set->info.anchors ||
      weight != set->info.weights || atom != set->info.atoms || dense != set->info.dense)
    nmc__fail(c, NMC_ERROR_CORRUPT);
}

/* ---- From levels to values ---- */

/* exp(v) as quaternion x, y, z, w. */
NMC__INLINE void nmc__exponential(const double *v, double *e) {
  const double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  double s, c;
  int i;
  if (square < 2) { /* half the angle is below pi / 4 */
    s = 0.5 * nmc__sine_ratio(square / 4);
    c = nmc__cosine(square / 4);
  } else {
    const double angle = NMC_SQRT(square);
    nmc__sin_cos(angle / (4 * nmc__pi), &s, &c);
    s /= angle;
  }
  for (i = 0; i < 3; ++i) e[i] = v[i] * s;
  e[3] = c;
}

/* q = reference * e, of unit length; both are, but for rounding. */
NMC__INLINE void nmc__turned(const double *reference, const double *e, float *q) {
  double r[4], scale;
  int i;
  r[0] = reference[3] * e[0] + reference[0] * e[3] + reference[1] * e[2] - reference[2] * e[1];
  r[1] = reference[3] * e[1] + reference[1] * e[3] + reference[2] * e[0] - reference[0] * e[2];
  r[2] = reference[3] * e[2] + reference[2] * e[3] + reference[0] * e[1] - reference[1] * e[0];
  r[3] = reference[3] * e[3] - reference[0] * e[0] - reference[1] * e[1] - reference[2] * e[2];
  scale = nmc__inverse_root((r[0] * r[0] + r[1] * r[1]) + (r[2] * r[2] + r[3] * r[3]));
  for (i = 0; i < 4; ++i) q[i] = (float)(r[i] * scale);
}

static void nmc__rotation(const double *v, const double *reference, float *q) {
  double e[4];
  nmc__exponential(v, e);
  nmc__turned(reference, e, q);
}

static nmc_result nmc__settle_references(nmc_set *set) {
  uint32_t t, a;
  for (t = 0; t < set->info.targets; ++t) {
    const nmc_target *target = &set->targets[t];
    float *pose = set->pose + target->offset, *reference = set->references + target->offset;
    const double identity[4] = {0, 0, 0, 1};
    double v[3], length = 0;
    if (set->exact_references) {
      memcpy(pose, reference, target->width * sizeof(float));
      if (target->path != NMC_ROTATION) continue;
      for (a = 0; a < 4; ++a) length += (double)pose[a] * pose[a];
      if (!(length >= 0.9801 && length <= 1.0201)) return NMC_ERROR_CORRUPT;
      continue;
    }
    for (a = 0; a < (target->path == NMC_ROTATION ? 3u : target->width); ++a)
      reference[a] = (float)(reference[a] * nmc__anchor_step(set, target->offset + a));
    if (target->path == NMC_ROTATION) {
      for (a = 0; a < 3; ++a) v[a] = reference[a];
      if (!(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] < 1000)) return NMC_ERROR_CORRUPT;
      nmc__rotation(v, identity, pose);
    } else {
      for (a = 0; a < target->width; ++a) pose[a] = reference[a] + (target->path == NMC_SCALE ? 1.0f : 0.0f);
    }
  }
  return NMC_OK;
}

static void nmc__settle_clip(nmc_set *set, uint32_t index) {
  nmc_clip *clip = &set->clips[index];
  const uint8_t *states = set->states + (size_t)index * set->info.targets;
  int32_t *slots = set->levels; /* the slot of each parameter */
  uint32_t t, a, r, k, i, parameter = 0;
  float *anchors = set->anchors + clip->first_anchor;
  for (t = 0; t < set->info.targets; ++t) {
    const uint32_t n = nmc__parameters(&set->targets[t], states[t]);
    for (a = 0; a < n; ++a, ++parameter) {
      const double step = nmc__anchor_step(set, set->targets[t].offset + a);
      slots[parameter] = (int32_t)(set->targets[t].offset + a);
      for (r = 0; r < clip->anchor_rows; ++r) anchors[(size_t)r * clip->parameters + parameter] *= (float)step;
    }
  }
  for (k = 0; k < clip->windows; ++k) {
    const nmc_window *w = &set->windows[clip->first_window + k];
    for (i = w->first_weight; i < w->first_weight + w->weights; ++i) {
      const uint32_t slot = (uint32_t)slots[set->weights[i].parameter];
      set->weights[i].value *= (float)nmc__weight_step(set, clip, slot, w->length);
    }
  }
  for (k = 0; k < clip->atoms; ++k) {
    nmc_atom *atom = &set->atoms[clip->first_atom + k];
    atom->value *= (float)nmc__anchor_step(set, (uint32_t)slots[atom->parameter]);
    if (atom->width == NMC_JUMP)
      clip->jumps = 1;
    else if (atom->width > clip->widest)
      clip->widest = (uint8_t)atom->width;
  }
}

/* The step that follows a quantised tensor is multiplied in. */
static void nmc__settle_tensor(float *values, uint64_t count) {
  uint64_t i;
  for (i = 0; i < count; ++i) values[i] *= values[count];
}

static void nmc__settle_network(nmc_set *set) {
  const uint64_t h0 = set->info.hidden0, h1 = set->info.hidden1, m = set->outputs;
  float *at = set->dense + set->first_shared;
  uint32_t k;
  if (!set->quantized_network) return;
  for (k = 0; k < set->info.clips; ++k) {
    const uint64_t inputs = 2 * (uint64_t)set->clips[k].frequencies + 1;
    float *w0 = set->dense + set->clips[k].first_dense + set->clips[k].frequencies;
    nmc__settle_tensor(w0, h0 * inputs);
    nmc__settle_tensor(w0 + h0 * inputs + 1, h0);
  }
  nmc__settle_tensor(at, h1 * h0);
  at += h1 * h0 + 1;
  nmc__settle_tensor(at, h1);
  at += h1 + 1;
  nmc__settle_tensor(at, m * h1);
  at += m * h1 + 1;
  nmc__settle_tensor(at, m);
}

static nmc_result nmc__settle(nmc_set *set) {
  uint32_t k;
  const nmc_result r = nmc__settle_references(set);
  if (r != NMC_OK) return r;
  for (k = 0; k < set->info.clips; ++k) nmc__settle_clip(set, k);
  if (set->has_network) nmc__settle_network(set);
  return NMC_OK;
}

static nmc_result nmc__open(nmc_set *set, const uint8_t *bytes, size_t size, void *workspace, size_t workspace_bytes,
                            double *bits) {
  nmc__coder c;
  nmc_result r;
  uint32_t i, stored;
  memset(set, 0, sizeof(*set));
  r = nmc_read_info(bytes, size, &set->info);
  if (r != NMC_OK) return r;
  stored = (uint32_t)bytes[4] | (uint32_t)bytes[5] << 8 | (uint32_t)bytes[6] << 16 | (uint32_t)bytes[7] << 24;
  if (nmc__crc(bytes + 8, size - 8) != stored) return NMC_ERROR_CHECKSUM;
  r = nmc__carve(set, workspace, workspace_bytes);
  if (r != NMC_OK) return r;
  memset(&c, 0, sizeof(c));
  c.high = 0xffffffffu;
  c.bytes = bytes + set->info.header_bytes;
  c.size = size - set->info.header_bytes;
  c.most_decisions = (uint64_t)NMC__DECISIONS_PER_BYTE * c.size + NMC__FREE_DECISIONS;
  c.models = set->models;
#ifdef NMC_ENCODER
  c.bits = bits;
#else
  (void)bits;
#endif
  for (i = 0; i < 4; ++i, ++c.at) c.code = (c.code << 8) | (c.at < c.size ? c.bytes[c.at] : 0u);
  nmc__code_payload(&c, set);
  return c.result != NMC_OK ? c.result : nmc__settle(set);
}

nmc_result nmc_open(nmc_set *set, const void *bytes, size_t size, void *workspace, size_t workspace_bytes) {
  return nmc__open(set, (const uint8_t *)bytes, size, workspace, workspace_bytes, NULL);
}

const float *nmc_times(const nmc_set *set, uint32_t clip) {
  return clip < set->info.clips ? set->times + set->clips[clip].first_time : NULL;
}

int nmc_state(const nmc_set *set, uint32_t clip, uint32_t target) {
  if (clip >= set->info.clips || target >= set->info.targets) return NMC_ABSENT;
  return set->states[(size_t)clip * set->info.targets + target];
}

/* ---- Evaluation ---- */

/* In turns of 2 pi: by what a window's features turn from one to the next at sample n. */
static double nmc__turns(const nmc_clip *clip, const nmc_window *w, uint32_t n) {
  if (clip->basis == NMC_COSINE) return (2.0 * n + 1) / (4.0 * w->length);
  return (double)(n - w->begin) / (clip->basis == NMC_PERIODIC ? 1.0 * w->length : 2.0 * w->length);
}

/* Features 1 .. count of sample n, or of n and n + 1 side by side: feature j of sample n + i into f[j * samples + i].
 * One sine and cosine, then rotations by the first angle. */
NMC__INLINE void nmc__features(const nmc_clip *clip, const nmc_window *w, uint32_t n, uint32_t count, double *f,
                               const int samples) {
  double s1[2], c1[2], s[2], c[2];
  uint32_t j;
  int i;
  if (count == 0) return;
  for (i = 0; i < samples; ++i) {
    nmc__sin_cos(nmc__turns(clip, w, n + (uint32_t)i), &s1[i], &c1[i]);
    s[i] = s1[i];
    c[i] = c1[i];
  }
  for (j = 1; j <= count; ++j) {
    const int cosine = clip->basis == NMC_PERIODIC ? (int)(j & 1u) : clip->basis == NMC_COSINE;
    for (i = 0; i < samples; ++i) f[j * (uint32_t)samples + (uint32_t)i] = cosine ? c[i] : s[i];
    if (cosine && clip->basis == NMC_PERIODIC) continue;
    for (i = 0; i < samples; ++i) {
      const double t = c[i] * c1[i] - s[i] * s1[i];
      s[i] = s[i] * c1[i] + c[i] * s1[i];
      c[i] = t;
    }
  }
}

static double nmc__elu(double x) { return x > 0 ? x : nmc__exp(x) - 1; }

/* out = act(W in + b), W rows x columns column by column; rows of b follow W. */
static void nmc__layer(const float *w, const float *b, uint32_t rows, uint32_t columns, const double *in, double *out) {
  uint32_t r, k;
  for (r = 0; r < rows; ++r) out[r] = b[r];
  for (k = 0; k < columns; ++k)
    for (r = 0; r < rows; ++r) out[r] += w[(size_t)k * rows + r] * in[k];
}

static void nmc__network(const nmc_set *set, const nmc_clip *clip, const uint8_t *states, uint32_t n, double *y,
                         double *work) {
  const uint32_t h0 = set->info.hidden0, h1 = set->info.hidden1, extra = set->quantized_network ? 1u : 0u;
  const uint32_t inputs = 2 * clip->frequencies + 1;
  const float *frequencies = set->dense + clip->first_dense;
  const float *w0 = frequencies + clip->frequencies, *b0 = w0 + (size_t)h0 * inputs + extra;
  const float *w1 = set->dense + set->first_shared, *b1 = w1 + (size_t)h1 * h0 + extra;
  const float *w2 = b1 + h1 + extra, *b2 = w2 + (size_t)set->outputs * h1 + extra;
  const double t = clip->samples > 1 ? (double)n / (clip->samples - 1) : 0;
  double *x = work, *z = x + inputs, *a = z + h0;
  uint32_t k, i, target, parameter = 0, output = 0;
  x[0] = t;
  for (k = 0; k < clip->frequencies; ++k) nmc__sin_cos(frequencies[k] * t / 2, &x[1 + 2 * k], &x[2 + 2 * k]);
  nmc__layer(w0, b0, h0, inputs, x, z);
  for (i = 0; i < h0; ++i) z[i] = nmc__elu(z[i]);
  nmc__layer(w1, b1, h1, h0, z, a);
  for (i = 0; i < h1; ++i) a[i] = nmc__elu(a[i]);
  for (target = 0; target < set->info.targets; ++target) {
    const uint32_t count = nmc__parameters(&set->targets[target], states[target]);
    if (states[target] >= NMC_MOVING) {
      for (i = 0; i < count; ++i, ++output) {
        double sum = b2[output];
        for (k = 0; k < h1; ++k) sum += w2[(size_t)k * set->outputs + output] * a[k];
        y[parameter + i] += sum;
      }
    }
    parameter += count;
  }
}

static uint32_t nmc__window_of(const nmc_set *set, const nmc_clip *clip, uint32_t n) {
  uint32_t low = 0, high = clip->windows - 1;
  while (low < high) {
    const uint32_t middle = (low + high + 1) / 2;
    if (set->windows[clip->first_window + middle].begin <= n)
      low = middle;
    else
      high = middle - 1;
  }
  return low;
}

/* Adds the windows' weights of one sample, or of two at once, whose features stand side by side. */
NMC__INLINE void nmc__add_weights(const nmc_weight *weight, const nmc_weight *end, const double *f, double *const y[2],
                                  const int count) {
  int i;
  while (weight != end) { /* weights of one parameter stand together */
    const uint32_t parameter = weight->parameter;
    double sum[2] = {0, 0};
    do {
      for (i = 0; i < count; ++i) sum[i] += weight->value * f[weight->feature * count + i];
      ++weight;
    } while (weight != end && weight->parameter == parameter);
    for (i = 0; i < count; ++i) y[i][parameter] += sum[i];
  }
}

static void nmc__add_atom(const nmc_atom *atom, uint32_t n, double *y) {
  const uint32_t away = n > atom->sample ? n - atom->sample : atom->sample - n;
  double s, c;
  if (atom->width == NMC_JUMP || away >> atom->width) return;
  nmc__sin_cos((double)away / (2.0 * (1u << atom->width)), &s, &c);
  y[atom->parameter] += atom->value * 0.5 * (1 + c);
}

/* The first of a clip's atoms, which are sorted by sample, that stands at sample + ahead > n. */
static uint32_t nmc__first_atom(const nmc_set *set, const nmc_clip *clip, uint32_t ahead, uint32_t n) {
  const nmc_atom *atoms = set->atoms + clip->first_atom;
  uint32_t low = 0, high = clip->atoms;
  while (low < high) {
    const uint32_t middle = (low + high) / 2;
    if (atoms[middle].sample + ahead <= n)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* The window's jumps lie after its first sample, up to the first one of the next window. */
static void nmc__add_jumps(const nmc_set *set, const nmc_clip *clip, const nmc_window *w, uint32_t n,
                           double *const y[2], int count) {
  const nmc_atom *atoms = set->atoms + clip->first_atom;
  uint32_t k = nmc__first_atom(set, clip, 0, w->begin);
  double line[2];
  int i;
  for (i = 0; i < count; ++i) line[i] = clip->anchor_rows == 1 ? 0 : (double)(n + (uint32_t)i - w->begin) / w->length;
  for (; k < clip->atoms && atoms[k].sample <= w->begin + w->length; ++k) {
    if (atoms[k].width != NMC_JUMP) continue;
    for (i = 0; i < count; ++i)
      y[i][atoms[k].parameter] += atoms[k].value * ((n + (uint32_t)i >= atoms[k].sample ? 1 : 0) - line[i]);
  }
}

/* Of the others those that the widest can bring to one of `count` samples from n on. */
static void nmc__add_atoms(const nmc_set *set, const nmc_clip *clip, uint32_t n, double *const y[2], int count) {
  const nmc_atom *atoms = set->atoms + clip->first_atom;
  const uint32_t reach = 1u << clip->widest;
  uint32_t low = nmc__first_atom(set, clip, reach, n);
  int i;
  for (; low < clip->atoms && atoms[low].sample < n + (uint32_t)(count - 1) + reach; ++low)
    for (i = 0; i < count; ++i) nmc__add_atom(&atoms[low], n + (uint32_t)i, y[i]);
}

/* The clip's parameters at sample n, or at n and n + 1 (count 2), which the same window covers: it ends where the next
 * one begins. */
NMC__INLINE void nmc__parameters_at(const nmc_set *set, const nmc_clip *clip, const uint8_t *states, uint32_t n,
                                    double *const y[2], double *work, const int count) {
  const nmc_window *w = &set->windows[clip->first_window + nmc__window_of(set, clip, n)];
  const nmc_weight *weight = set->weights + w->first_weight, *end = weight + w->weights;
  const uint32_t k = clip->anchor_rows == 1 ? 0 : (uint32_t)(w - set->windows) - clip->first_window;
  const float *row = set->anchors + clip->first_anchor + (size_t)k * clip->parameters;
  const float *after = clip->anchor_rows == 1 ? row : row + clip->parameters;
  uint32_t p;
  int i;
  for (i = 0; i < count; ++i) {
    const double u = (double)(n + (uint32_t)i - w->begin) / w->length;
    for (p = 0; p < clip->parameters; ++p) y[i][p] = row[p] + u * ((double)after[p] - row[p]);
  }
  nmc__features(clip, w, n, w->features, work, count);
  nmc__add_weights(weight, end, work, y, count);
  nmc__add_atoms(set, clip, n, y, count);
  if (clip->jumps) nmc__add_jumps(set, clip, w, n, y, count);
  if (!set->has_network) return;
  for (i = 0; i < count; ++i) nmc__network(set, clip, states, n + (uint32_t)i, y[i], work);
}

/* A target's value from its parameters. */
NMC__INLINE void nmc__value(const nmc_target *target, const float *reference, int state, uint32_t count,
                            const double *y, float *out) {
  uint32_t a;
  if (state == NMC_QUATERNION) {
    const double length = NMC_SQRT(y[0] * y[0] + y[1] * y[1] + y[2] * y[2] + y[3] * y[3]);
    for (a = 0; a < 4; ++a) out[a] = length > 1e-12 ? (float)(y[a] / length) : (a == 3 ? 1.0f : 0.0f);
  } else if (target->path == NMC_ROTATION && count && (y[0] != 0 || y[1] != 0 || y[2] != 0)) {
    double q[4];
    for (a = 0; a < 4; ++a) q[a] = reference[a];
    nmc__rotation(y, q, out);
  } else {
    for (a = 0; a < target->width; ++a)
      out[a] = reference[a] + (count && target->path != NMC_ROTATION ? (float)y[a] : 0.0f);
  }
}

/* Scratch memory: parameters of two samples, then what they are made from. */
static double *nmc__divide(const nmc_set *set, void *scratch, double *y[2]) {
  y[0] = (double *)scratch;
  y[1] = y[0] + set->info.slots;
  return y[1] + set->info.slots;
}

nmc_result nmc_sample(const nmc_set *set, uint32_t index, uint32_t n, float *pose, void *scratch) {
  const uint8_t *states;
  const double *at;
  double *y[2], *work;
  uint32_t t;
  if (index >= set->info.clips || n >= set->clips[index].samples) return NMC_ERROR_ARGUMENT;
  states = set->states + (size_t)index * set->info.targets;
  work = nmc__divide(set, scratch, y);
  nmc__parameters_at(set, &set->clips[index], states, n, y, work, 1);
  at = y[0];
  for (t = 0; t < set->info.targets; ++t) {
    const nmc_target *target = &set->targets[t];
    const uint32_t count = nmc__parameters(target, states[t]);
    nmc__value(target, set->pose + target->offset, states[t], count, at, pose + target->offset);
    at += count;
  }
  return NMC_OK;
}

/* What is the same for all rotations between two samples. */
typedef struct nmc__between {
  double u;
  double first[8];  /* terms of nmc__share for 1 - u */
  double second[8]; /* for u */
} nmc__between;

static void nmc__share_terms(double u, double *terms) {
  static const double factors[8] = {1.0 / 3, 1.0 / 10, 1.0 / 21, 1.0 / 36, 1.0 / 55, 1.0 / 78, 1.0 / 105, 1.0 / 136};
  const double w = u * u;
  double term = 1;
  int k;
  for (k = 1; k <= 8; ++k) terms[k - 1] = term *= (w - k * k) * factors[k - 1];
}

static void nmc__start_between(double u, nmc__between *between) {
  between->u = u;
  nmc__share_terms(1 - u, between->first);
  nmc__share_terms(u, between->second);
}

/* sin(u x) / sin x of z = cos x - 1, 0 <= u <= 1, -0.12 <= z <= 0, error below 1e-11: the series in z, each of whose
 * terms is the one before times z (u^2 - k^2) / (k (2 k + 1)). Terms in pairs do not wait for each other. */
NMC__INLINE double nmc__share(double u, const double *t, double z) {
  const double z2 = z * z, z4 = z2 * z2;
  return u *
         ((1 + t[0] * z) + z2 * (t[1] + t[2] * z) + z4 * (t[3] + t[4] * z) + z4 * z2 * ((t[5] + t[6] * z) + t[7] * z2));
}

/* On the short arc; the result's length is 1 but for rounding. */
NMC__INLINE void nmc__slerp(const double *a, const double *b, const nmc__between *between, double *out) {
  double dot = (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3]);
  double sign, wa, wb;
  int i;
  sign = dot < 0 ? -1 : 1;
  dot *= sign;
  if (dot > 1) dot = 1;
  if (dot >= 0.88) {
    wa = nmc__share(1 - between->u, between->first, dot - 1);
    wb = nmc__share(between->u, between->second, dot - 1);
  } else {
    double away = 0, angle, s, sa, sb, unused;
    for (i = 0; i < 4; ++i) away += (sign * b[i] - dot * a[i]) * (sign * b[i] - dot * a[i]);
    s = NMC_SQRT(away);
    angle = nmc__angle(s, dot);
    nmc__sin_cos((1 - between->u) * angle / (2 * nmc__pi), &sa, &unused);
    nmc__sin_cos(between->u * angle / (2 * nmc__pi), &sb, &unused);
    wa = sa / s;
    wb = sb / s;
  }
  wb *= sign;
  for (i = 0; i < 4; ++i) out[i] = wa * a[i] + wb * b[i];
}

/* A rotation between its vectors at two samples: what turns the reference is slerped, and the reference turned once. */
static void nmc__vector_between(const double *first, const double *second, const double *reference,
                                const nmc__between *between, float *out) {
  double ends[2][4], q[4];
  nmc__exponential(first, ends[0]);
  nmc__exponential(second, ends[1]);
  nmc__slerp(ends[0], ends[1], between, q);
  nmc__turned(reference, q, out);
}

/* The same of a target that is held as a quaternion. */
static void nmc__quaternion_between(const nmc_target *target, const float *reference, const double *const at[2],
                                    const nmc__between *between, float *out) {
  static const double identity[4] = {0, 0, 0, 1};
  double ends[2][4], q[4];
  int i, k;
  for (i = 0; i < 2; ++i) {
    float value[4];
    nmc__value(target, reference, NMC_QUATERNION, 4, at[i], value);
    for (k = 0; k < 4; ++k) ends[i][k] = value[k];
  }
  nmc__slerp(ends[0], ends[1], between, q);
  nmc__turned(identity, q, out);
}

/* Moving rotations on their way between two samples: so many that the processor's wide instructions pay. */
enum { NMC__LANES = 16 };

typedef struct nmc__lanes {
  uint32_t count;
  double v[2][3][NMC__LANES]; /* parameters at the two samples */
  double reference[4][NMC__LANES];
  float *out[NMC__LANES];
} nmc__lanes;

/* nmc__vector_between without its branches, which loops that are to run side by side cannot have. usual: where that is
 * allowed; elsewhere q means nothing. */
static void nmc__lanes_between(const nmc__lanes *lanes, const nmc__between *between, double q[4][NMC__LANES],
                               uint8_t *usual) {
  const double u = between->u, *first = between->first, *second = between->second;
  double e[2][4][NMC__LANES], largest[NMC__LANES], dots[NMC__LANES], lengths[NMC__LANES];
  int i, k;
  for (k = 0; k < NMC__LANES; ++k) largest[k] = 0;
  for (i = 0; i < 2; ++i) {
    for (k = 0; k < NMC__LANES; ++k) {
      const double x = lanes->v[i][0][k], y = lanes->v[i][1][k], z = lanes->v[i][2][k];
      const double square = x * x + y * y + z * z, s = 0.5 * nmc__sine_ratio(square / 4);
      e[i][0][k] = x * s;
      e[i][1][k] = y * s;
      e[i][2][k] = z * s;
      e[i][3][k] = nmc__cosine(square / 4);
      largest[k] = square > largest[k] ? square : largest[k];
    }
  }
  for (k = 0; k < NMC__LANES; ++k) {
    const double dot =
        (e[0][0][k] * e[1][0][k] + e[0][1][k] * e[1][1][k]) + (e[0][2][k] * e[1][2][k] + e[0][3][k] * e[1][3][k]);
    const double wa = nmc__share(1 - u, first, dot - 1), wb = nmc__share(u, second, dot - 1);
    const double a = wa * e[0][0][k] + wb * e[1][0][k], b = wa * e[0][1][k] + wb * e[1][1][k],
                 c = wa * e[0][2][k] + wb * e[1][2][k], d = wa * e[0][3][k] + wb * e[1][3][k];
    const double rx = lanes->reference[0][k], ry = lanes->reference[1][k], rz = lanes->reference[2][k],
                 rw = lanes->reference[3][k];
    const double x = rw * a + rx * d + ry * c - rz * b, y = rw * b + ry * d + rz * a - rx * c,
                 t = rw * c + rz * d + rx * b - ry * a, w = rw * d - rx * a - ry * b - rz * c;
    const double away = (x * x + y * y) + (t * t + w * w) - 1, scale = nmc__near_inverse_root(away);
    q[0][k] = x * scale;
    q[1][k] = y * scale;
    q[2][k] = t * scale;
    q[3][k] = w * scale;
    dots[k] = dot;
    lengths[k] = away;
  }
  for (k = 0; k < NMC__LANES; ++k)
    usual[k] = largest[k] < 2 && dots[k] >= 0.88 && lengths[k] > -1e-4 && lengths[k] < 1e-4;
}

static void nmc__finish_lanes(nmc__lanes *lanes, const nmc__between *between) {
  double q[4][NMC__LANES];
  uint8_t usual[NMC__LANES];
  uint32_t k;
  int i, j;
  nmc__lanes_between(lanes, between, q, usual);
  for (k = 0; k < lanes->count; ++k) {
    double v[2][3], reference[4];
    if (usual[k]) {
      for (i = 0; i < 4; ++i) lanes->out[k][i] = (float)q[i][k];
      continue;
    }
    for (j = 0; j < 2; ++j)
      for (i = 0; i < 3; ++i) v[j][i] = lanes->v[j][i][k];
    for (i = 0; i < 4; ++i) reference[i] = lanes->reference[i][k];
    nmc__vector_between(v[0], v[1], reference, between, lanes->out[k]);
  }
  lanes->count = 0;
}

static void nmc__add_lane(nmc__lanes *lanes, const double *const at[2], const float *reference, float *out,
                          const nmc__between *between) {
  const uint32_t k = lanes->count++;
  int i, j;
  for (j = 0; j < 2; ++j)
    for (i = 0; i < 3; ++i) lanes->v[j][i][k] = at[j][i];
  for (i = 0; i < 4; ++i) lanes->reference[i][k] = reference[i];
  lanes->out[k] = out;
  if (lanes->count == NMC__LANES) nmc__finish_lanes(lanes, between);
}

/* The sample n before a time; returns how far the time is from it to the next, 0 if only sample n counts. */
static double nmc__locate(const float *times, uint32_t samples, double seconds, uint32_t *n) {
  uint32_t low = 0, high = samples - 1;
  *n = seconds > times[0] ? high : 0;
  if (!(seconds > times[0]) || seconds >= times[high]) return 0;
  while (high - low > 1) {
    const uint32_t middle = low + (high - low) / 2;
    if (times[middle] <= seconds)
      low = middle;
    else
      high = middle;
  }
  *n = low;
  return (seconds - times[low]) / ((double)times[high] - times[low]);
}

/* The pose at the share u of the way from sample n to n + 1. */
static void nmc__pose_between(const nmc_set *set, uint32_t index, uint32_t n, double u, float *pose, void *scratch) {
  const uint8_t *states = set->states + (size_t)index * set->info.targets;
  const double *at[2];
  double *y[2], *work;
  nmc__between between;
  nmc__lanes lanes;
  uint32_t t, i;
  work = nmc__divide(set, scratch, y);
  nmc__parameters_at(set, &set->clips[index], states, n, y, work, 2);
  at[0] = y[0];
  at[1] = y[1];
  nmc__start_between(u, &between);
  memset(&lanes, 0, sizeof(lanes));
  for (t = 0; t < set->info.targets; ++t) {
    const nmc_target *target = &set->targets[t];
    const float *reference = set->pose + target->offset;
    float *out = pose + target->offset;
    const uint32_t count = nmc__parameters(target, states[t]);
    if (states[t] < NMC_MOVING) {
      nmc__value(target, reference, states[t], count, at[0], out);
    } else if (states[t] == NMC_QUATERNION) {
      nmc__quaternion_between(target, reference, at, &between, out);
    } else if (target->path == NMC_ROTATION) {
      nmc__add_lane(&lanes, at, reference, out, &between);
    } else {
      for (i = 0; i < target->width; ++i)
        out[i] = (float)((1 - u) * (reference[i] + (float)at[0][i]) + u * (reference[i] + (float)at[1][i]));
    }
    at[0] += count;
    at[1] += count;
  }
  if (lanes.count) nmc__finish_lanes(&lanes, &between);
}

nmc_result nmc_evaluate(const nmc_set *set, uint32_t index, double seconds, int mode, float *pose, void *scratch) {
  const nmc_clip *clip;
  const float *times;
  uint32_t n;
  double u;
  if (index >= set->info.clips || !(seconds - seconds == 0)) return NMC_ERROR_ARGUMENT;
  clip = &set->clips[index];
  times = set->times + clip->first_time;
  if (mode == NMC_LOOP && clip->samples > 1) {
    const double length = (double)times[clip->samples - 1] - times[0], turns = (seconds - times[0]) / length;
    if (turns > -4e15 && turns < 4e15) {
      double whole = (double)(int64_t)turns;
      if (whole > turns) whole -= 1;
      seconds -= whole * length;
    }
  }
  u = nmc__locate(times, clip->samples, seconds, &n);
  if (u == 0) return nmc_sample(set, index, n, pose, scratch);
  nmc__pose_between(set, index, n, u, pose, scratch);
  return NMC_OK;
}

/* ---- For the encoder ---- */

#ifdef NMC_ENCODER
uint32_t nmc_checksum(const uint8_t *bytes, size_t size) { return nmc__crc(bytes, size); }
float nmc_formula_time(const nmc_clip *clip, uint32_t n, float previous) {
  return nmc__formula_time(clip, n, previous);
}
void nmc_features(const nmc_clip *clip, const nmc_window *w, uint32_t n, uint32_t count, double *f) {
  nmc__features(clip, w, n, count, f, 1);
}
nmc_result nmc_carve(nmc_set *set, void *workspace, size_t workspace_bytes) {
  return nmc__carve(set, workspace, workspace_bytes);
}
void nmc_measure(nmc_info *info) { nmc__measure(info); }

nmc_result nmc_open_counting(nmc_set *set, const void *bytes, size_t size, void *workspace, size_t workspace_bytes,
                             double *bits) {
  return nmc__open(set, (const uint8_t *)bytes, size, workspace, workspace_bytes, bits);
}

nmc_result nmc_write_payload(nmc_set *set, nmc_sink *sink) {
  nmc__coder c;
  uint32_t k;
  memset(&c, 0, sizeof(c));
  c.high = 0xffffffffu;
  c.most_decisions = UINT64_MAX;
  c.models = set->models;
  c.sink = sink;
  nmc__code_payload(&c, set);
  if (c.result != NMC_OK || !sink->put) return c.result;
  /* The shortest bytes after which zeros lie in [low, high]. */
  for (k = 0; k < 4; ++k) {
    const uint64_t mask = 0xffffffffu >> (8 * k);
    if ((((uint64_t)c.low + mask) & ~mask) <= c.high) break;
  }
  {
    const uint64_t mask = k < 4 ? 0xffffffffu >> (8 * k) : 0u;
    const uint32_t value = (uint32_t)(((uint64_t)c.low + mask) & ~mask);
    uint32_t i;
    for (i = 0; i < k; ++i) sink->put(sink->user, (uint8_t)(value >> (24 - 8 * i)));
  }
  return NMC_OK;
}
#endif

#ifdef __cplusplus
}
#endif
#endif /* NMC_DECODE_IMPLEMENTED */
#endif /* NMC_DECODE_IMPLEMENTATION */
