/* Debian builds Ceres with SuiteSparse, parts of which are under the GPL (CHOLMOD's Supernodal, MatrixOps and Modify). Here
 * Ceres solves dense problems only and never calls it. These definitions take the place of what Ceres refers to, so that no
 * program is linked with SuiteSparse; a call would end the program. Checked by tests/installation/linked_libraries. */
#include <stdio.h>
#include <stdlib.h>

#define NOT_LINKED(function)                                                                        \
  __attribute__((visibility("hidden"), noreturn)) void function(void);                              \
  void function(void) {                                                                             \
    fputs("error: Ceres called " #function " of SuiteSparse, which is not linked\n", stderr);       \
    abort();                                                                                        \
  }

NOT_LINKED(cholmod_amd)
NOT_LINKED(cholmod_analyze)
NOT_LINKED(cholmod_analyze_p)
NOT_LINKED(cholmod_camd)
NOT_LINKED(cholmod_factorize)
NOT_LINKED(cholmod_finish)
NOT_LINKED(cholmod_free_dense)
NOT_LINKED(cholmod_free_factor)
NOT_LINKED(cholmod_free_sparse)
NOT_LINKED(cholmod_l_finish)
NOT_LINKED(cholmod_l_free_sparse)
NOT_LINKED(cholmod_l_start)
NOT_LINKED(cholmod_print_common)
NOT_LINKED(cholmod_solve)
NOT_LINKED(cholmod_start)
NOT_LINKED(cholmod_triplet_to_sparse)
NOT_LINKED(cholmod_zeros)
NOT_LINKED(cs_di_amd)
NOT_LINKED(cs_di_calloc)
NOT_LINKED(cs_di_chol)
NOT_LINKED(cs_di_cholsol)
NOT_LINKED(cs_di_compress)
NOT_LINKED(cs_di_counts)
NOT_LINKED(cs_di_cumsum)
NOT_LINKED(cs_di_etree)
NOT_LINKED(cs_di_free)
NOT_LINKED(cs_di_ipvec)
NOT_LINKED(cs_di_lsolve)
NOT_LINKED(cs_di_ltsolve)
NOT_LINKED(cs_di_malloc)
NOT_LINKED(cs_di_multiply)
NOT_LINKED(cs_di_nfree)
NOT_LINKED(cs_di_pinv)
NOT_LINKED(cs_di_post)
NOT_LINKED(cs_di_pvec)
NOT_LINKED(cs_di_schol)
NOT_LINKED(cs_di_sfree)
NOT_LINKED(cs_di_spfree)
NOT_LINKED(cs_di_symperm)
NOT_LINKED(cs_di_transpose)
/* SuiteSparseQR<double, long>() of SPQR, as Ceres 2.2 calls it */
NOT_LINKED(_Z13SuiteSparseQRIdlET0_idS0_P21cholmod_sparse_structPS2_PPS0_P21cholmod_common_struct)
