# Installs the build to a fresh prefix, then builds and runs the program of this folder against it
# as a stranger would: in an environment of its own, without this build's compiler flags.
#
# Called with -D BUILD_DIR, WORK_DIR, GENERATOR, CXX_COMPILER.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
unset(ENV{CXXFLAGS})
unset(ENV{LDFLAGS})
unset(ENV{DESTDIR})

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
# With Eigen for any machine, and for this one, in another part of the program.
foreach(flag -mtune=generic -march=native)
  run(${CMAKE_COMMAND}
      -S ${CMAKE_CURRENT_LIST_DIR}
      -B ${WORK_DIR}/build
      -G ${GENERATOR}
      -D CMAKE_BUILD_TYPE=Release
      -D CMAKE_CXX_FLAGS_RELEASE=-O1
      -D CMAKE_CXX_COMPILER=${CXX_COMPILER}
      -D CMAKE_PREFIX_PATH=${WORK_DIR}/prefix
      -D EIGEN_USER_FLAGS=${flag})
  run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
  run(${WORK_DIR}/build/consumer)
endforeach()
