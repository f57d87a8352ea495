# The installed tree, which may be moved as a whole, and the Debian package that CPack makes of it:
#   bin/bplbm   lib/bplbm/bin (the programs; `liggghts` is also Debian's)   share/bplbm/{tools,cases,tests}   share/doc/bplbm
# All documents lie in share/bplbm as in the sources, so that their links hold.
# Whatever is run from it writes into the current folder only.
include(GNUInstallDirs)
set(share ${CMAKE_INSTALL_DATADIR}/bplbm)

foreach(program lbm liggghts replay trace reference_engine c_engine scheme_report step_report)
  if(TARGET ${program})
    install(TARGETS ${program} DESTINATION lib/bplbm/bin)
  endif()
endforeach()
install(PROGRAMS tools/bplbm/bplbm.sh DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME bplbm)
install(DIRECTORY tools/bplbm DESTINATION ${share}/tools
  PATTERN __pycache__ EXCLUDE PATTERN checks EXCLUDE)
install(DIRECTORY tools/engines/python DESTINATION ${share}/tools/engines PATTERN __pycache__ EXCLUDE)
install(FILES tools/launch.py tools/pictures.py tools/trace_plot.py DESTINATION ${share}/tools)
install(DIRECTORY cases DESTINATION ${share} PATTERN __pycache__ EXCLUDE PATTERN out EXCLUDE
  PATTERN log.liggghts EXCLUDE)
install(DIRECTORY tests/hard DESTINATION ${share}/tests PATTERN __pycache__ EXCLUDE)
install(FILES tools/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME bplbm)

# Documents, and the files of the sources that they link to.
file(GLOB_RECURSE documents RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/lbm_solver/*.md ${PROJECT_SOURCE_DIR}/liggghts_coupling/*.md ${PROJECT_SOURCE_DIR}/protocol/*.md
  ${PROJECT_SOURCE_DIR}/tests/*.md ${PROJECT_SOURCE_DIR}/tools/*.md)
foreach(document README.md CHANGELOG.md CONTRIBUTING.md LICENSE lbm_solver/architecture.png
    lbm_solver/coupling/particles.h protocol/solid/bplbm_solid.h protocol/solid/bplbm_solid.f90 protocol/wire/channel.h
    tools/engines/c/engine.c tools/engines/fortran/engine.f90 ${documents})
  cmake_path(GET document PARENT_PATH folder)
  install(FILES ${document} DESTINATION ${share}/${folder})
endforeach()
install(FILES CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)

# What the programs ask of a processor, by the kernel's names: bplbm run refuses a machine that lacks it.
set(cpu_features "")
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -march=${BPLBM_CPU} -dM -E -x c++ /dev/null
    OUTPUT_VARIABLE macros RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "BPLBM_CPU=${BPLBM_CPU}: ${CMAKE_CXX_COMPILER} knows no such processor (-march)")
  endif()
  foreach(feature SSE4_2 AVX AVX2 FMA BMI2 AVX512F AVX512DQ AVX512BW AVX512VL)
    if(macros MATCHES "#define __${feature}__ ")
      string(TOLOWER ${feature} name)
      string(APPEND cpu_features "${name}\n")
    endif()
  endforeach()
endif()
file(WRITE ${CMAKE_BINARY_DIR}/cpu_features "${cpu_features}")
install(FILES ${CMAKE_BINARY_DIR}/cpu_features DESTINATION lib/bplbm)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME bplbm)
set(CPACK_PACKAGE_CONTACT "The BPLBM developers <bplbm@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "viscous fluid and moving grains: lattice Boltzmann coupled to LIGGGHTS")
set(CPACK_PACKAGE_DESCRIPTION "Two programs, started together by MPI, compute what a viscous fluid and moving, perhaps bonded
grains do to each other. The command bplbm makes, checks, runs and compares scenes from any folder.")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)  # the libraries, with their versions
set(CPACK_DEBIAN_PACKAGE_DEPENDS "openmpi-bin, python3 (>= 3.11), python3-numpy, python3-h5py, python3-matplotlib")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-mpi4py")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "paraview, python3-pandas")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
include(CPack)
