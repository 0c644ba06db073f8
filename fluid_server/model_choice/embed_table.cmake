# cmake -D INPUT=table.csv -D OUTPUT=measured_table_text.cpp -P embed_table.cmake
# Turns the table into a source file, so that the server needs no file beside it.
file(READ ${INPUT} text)
file(WRITE ${OUTPUT} "#include \"fluid_server/model_choice/table.hpp\"

namespace wade::fluid::model_choice {

std::string_view measured_table_text() {
    return R\"table(${text})table\";
}

}  // namespace wade::fluid::model_choice
")
