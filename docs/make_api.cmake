# Makes the API pages. Warnings are errors.
#
# Of what has no comment, variables are let pass: a member such as `action` needs none. Other things
# are errors unless undocumented.txt lists them; the list is there to become shorter.
# Needs DOXYGEN, DOXYFILE, OUTPUT_DIR, ALLOWED.
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${OUTPUT_DIR})
file(MAKE_DIRECTORY ${OUTPUT_DIR})
execute_process(COMMAND ${DOXYGEN} ${DOXYFILE} COMMAND_ERROR_IS_FATAL ANY)

file(STRINGS ${ALLOWED} allowed)
file(STRINGS ${OUTPUT_DIR}/warnings.txt warnings)
set(errors "")
foreach(warning IN LISTS warnings)
  set(name "")
  if(warning MATCHES "Member .* \\(variable\\) of .* is not documented")
    continue()
  elseif(warning MATCHES "Compound ([^ ]+) is not documented")
    set(name ${CMAKE_MATCH_1})
  elseif(warning MATCHES "Member ([^ (]+).* of [a-z]+ ([^ ]+) is not documented")
    set(name ${CMAKE_MATCH_2}::${CMAKE_MATCH_1})
  endif()
  if(NOT name IN_LIST allowed)
    string(APPEND errors "${warning}\n    ${name}\n")
  endif()
endforeach()
if(errors)
  message("${errors}")
  message(FATAL_ERROR "Doxygen warns; the names are what undocumented.txt would list")
endif()
message(STATUS "The API pages are in ${OUTPUT_DIR}/html/index.html")
