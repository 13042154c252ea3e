/* Prints the first pose of a stream's first clip. */
#define NMC_DECODE_IMPLEMENTATION
#include <nmc_decode.h>
#include <stdio.h>
#include <stdlib.h>

static unsigned char stream[4096];

int main(int count, char **arguments) {
  FILE *file = count > 1 ? fopen(arguments[1], "rb") : NULL;
  size_t size;
  nmc_info info;
  nmc_set set;
  nmc_result result;
  void *workspace, *scratch;
  float *pose;
  uint32_t i;
  if (!file) return 100;
  size = fread(stream, 1, sizeof(stream), file);
  fclose(file);
  result = nmc_read_info(stream, size, &info);
  if (result != NMC_OK) return (int)result;
  workspace = malloc(info.workspace_bytes);
  scratch = malloc(info.scratch_bytes);
  pose = (float *)malloc(info.slots * sizeof(float));
  result = nmc_open(&set, stream, size, workspace, info.workspace_bytes);
  if (result == NMC_OK) result = nmc_sample(&set, 0, 0, pose, scratch);
  for (i = 0; result == NMC_OK && i < info.slots; ++i) printf("%.9g\n", (double)pose[i]);
  free(pose);
  free(scratch);
  free(workspace);
  return (int)result;
}
