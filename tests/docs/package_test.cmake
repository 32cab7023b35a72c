# Installs carnot and configures the example of README.md as its reader does; that carnot::shooting
# links is seen by the install test. Needs BUILD_DIR, EXAMPLE_DIR, WORK_DIR, GENERATOR,
# CXX_COMPILER.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
unset(ENV{DESTDIR})

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
run(${CMAKE_COMMAND}
    -S ${EXAMPLE_DIR}
    -B ${WORK_DIR}/build
    -G ${GENERATOR}
    -D CMAKE_BUILD_TYPE=Release
    -D CMAKE_CXX_COMPILER=${CXX_COMPILER}
    -D CMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
