# wade_python_test(NAME word ...): the test NAME, `python3 word ...` in the current folder with the package of tools/python.
function(wade_python_test name)
  add_test(NAME ${name} COMMAND /usr/bin/python3 -B ${ARGN} WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
  wade_finds_python(${name})
endfunction()

# wade_finds_python(NAME): lets what a test starts find the package of tools/python and the programs of this build.
function(wade_finds_python name)
  set_tests_properties(${name} PROPERTIES
    ENVIRONMENT_MODIFICATION
      "PYTHONPATH=path_list_prepend:${PROJECT_SOURCE_DIR}/tools/python;WADE_BUILD=set:${PROJECT_BINARY_DIR}")
endfunction()
