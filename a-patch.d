patch.o: lbm_solver/boundary/patch.cpp \
 /tmp/vis/drv/lbm_solver/boundary/patch.h \
 /tmp/vis/drv/lbm_solver/base/side.h \
 /tmp/vis/drv/lbm_solver/boundary/in_time.h \
 /tmp/vis/drv/lbm_solver/field/cell_pass.h \
 /tmp/vis/drv/lbm_solver/field/esoteric_pull.h \
 /tmp/vis/drv/lbm_solver/base/unroll.h \
 /tmp/vis/drv/lbm_solver/field/domain.h \
 /tmp/vis/drv/lbm_solver/base/vec3.h \
 /tmp/vis/drv/lbm_solver/field/populations.h \
 /tmp/vis/drv/lbm_solver/lattice/lattice.h
