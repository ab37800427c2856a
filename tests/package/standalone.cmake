# cmake -DSOURCE_DIR= -DFOLDER= -DGENERATOR= -P standalone.cmake
# The product stands alone: without tests/ and bench/, and where there is neither Boost nor doctest, it
# configures, and no file of it includes anything of them.
set(tree ${FOLDER}/tree)
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${tree})
set(rooms core flatland wave_solver grin mc apps)
foreach(entry CMakeLists.txt LICENSE cmake data plots ${rooms})
  file(CREATE_LINK ${SOURCE_DIR}/${entry} ${tree}/${entry} SYMBOLIC)
endforeach()

execute_process(COMMAND ${CMAKE_COMMAND} -S ${tree} -B ${FOLDER}/build -G ${GENERATOR}
                        -DCMAKE_DISABLE_FIND_PACKAGE_Boost=ON -DCMAKE_DISABLE_FIND_PACKAGE_doctest=ON
                COMMAND_ERROR_IS_FATAL ANY)

foreach(room ${rooms})
  file(GLOB_RECURSE files ${SOURCE_DIR}/${room}/*.h ${SOURCE_DIR}/${room}/*.cpp)
  foreach(file ${files})
    file(STRINGS ${file} includes REGEX "^#include [<\"](tests|bench|boost|doctest)/")
    if(includes)
      message(SEND_ERROR "${file}: ${includes}")
    endif()
  endforeach()
endforeach()
