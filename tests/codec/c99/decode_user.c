/* Plays a stream as a C99 program does: prints the pose of each clip at each given time, one number a line. */
#define NMC_DECODE_IMPLEMENTATION
#include <stdio.h>
#include <stdlib.h>

#include "nmc_decode.h"

static void *load(const char *path, size_t *size) {
  FILE *file = fopen(path, "rb");
  long length;
  void *bytes;
  if (!file) return NULL;
  fseek(file, 0, SEEK_END);
  length = ftell(file);
  fseek(file, 0, SEEK_SET);
  bytes = malloc(length > 0 ? (size_t)length : 1);
  *size = bytes && length > 0 ? fread(bytes, 1, (size_t)length, file) : 0;
  fclose(file);
  return bytes;
}

static int play(const nmc_set *set, double seconds) {
  float *pose = (float *)malloc(set->info.slots * sizeof(float) + 1);
  void *scratch = malloc(set->info.scratch_bytes);
  uint32_t clip, i;
  nmc_result result = NMC_OK;
  for (clip = 0; clip < set->info.clips && result == NMC_OK; ++clip) {
    result = nmc_evaluate(set, clip, seconds, NMC_LOOP, pose, scratch);
    for (i = 0; i < set->info.slots; ++i) printf("%.9g\n", (double)pose[i]);
  }
  free(scratch);
  free(pose);
  return (int)result;
}

int main(int count, char **arguments) {
  size_t size = 0;
  void *bytes = count > 1 ? load(arguments[1], &size) : NULL, *workspace;
  nmc_info info;
  nmc_set set;
  nmc_result result;
  int i, status = 0;
  if (!bytes) return 100;
  result = nmc_read_info(bytes, size, &info);
  if (result != NMC_OK) {
    fprintf(stderr, "%s\n", nmc_message(result));
    return (int)result;
  }
  workspace = malloc(info.workspace_bytes);
  result = nmc_open(&set, bytes, size, workspace, info.workspace_bytes);
  free(bytes);
  if (result != NMC_OK) fprintf(stderr, "%s\n", nmc_message(result));
  for (i = 2; i < count && result == NMC_OK && status == 0; ++i) status = play(&set, atof(arguments[i]));
  free(workspace);
  return result != NMC_OK ? (int)result : status;
}
