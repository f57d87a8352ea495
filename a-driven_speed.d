driven_speed.o: lbm_solver/solver/driven_speed.cpp \
 /tmp/vis/drv/lbm_solver/solver/driven_speed.h \
 /tmp/vis/drv/lbm_solver/base/scene.h /tmp/vis/drv/lbm_solver/base/side.h \
 /tmp/vis/drv/lbm_solver/base/units.h /tmp/vis/drv/lbm_solver/base/vec3.h \
 /work/wt-viscosity/protocol/messages.h
