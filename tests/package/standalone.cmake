# cmake -DSOURCE_DIR= -DFOLDER= -DGENERATOR= -P standalone.cmake
# Checks that the product stands alone: without tests/ and bench/, Boost and doctest it configures, and none of its
# files includes any of them.
set(tree ${FOLDER}/tree)
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${tree})
set(modules core flatland wave_solver grin mc apps)
foreach(entry CMakeLists.txt LICENSE cmake data plots ${modules})
  file(CREATE_LINK ${SOURCE_DIR}/${entry} ${tree}/${entry} SYMBOLIC)
endforeach()

execute_process(COMMAND ${CMAKE_COMMAND} -S ${tree} -B ${FOLDER}/build -G ${GENERATOR}
                        -DCMAKE_DISABLE_FIND_PACKAGE_Boost=ON -DCMAKE_DISABLE_FIND_PACKAGE_doctest=ON
                COMMAND_ERROR_IS_FATAL ANY)

foreach(module ${modules})
  file(GLOB_RECURSE files ${SOURCE_DIR}/${module}/*.h ${SOURCE_DIR}/${module}/*.cpp)
  foreach(file ${files})
    file(STRINGS ${file} includes REGEX "^#include [<\"](tests|bench|boost|doctest)/")
    if(includes)
      message(SEND_ERROR "${file}: ${includes}")
    endif()
  endforeach()
endforeach()
