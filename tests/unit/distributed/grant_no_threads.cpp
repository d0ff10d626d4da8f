// A library that test_ranks.py loads before a program: its MPI grants no threads.
#include <mpi.h>

extern "C" int MPI_Init_thread(int* argc, char*** argv, int required, int* granted) {
  const int result = PMPI_Init_thread(argc, argv, required, granted);
  *granted = MPI_THREAD_SINGLE;
  return result;
}
