#include "host_tools/lib/recording/reader.hpp"

#include <utility>

namespace zerorate::recording {

Reader::Reader(const Input& input) : Reader(open_rows(input)) {}

Reader::Reader(std::unique_ptr<RowSource> rows) : rows_(std::move(rows)) {}

bool Reader::next(Row& row) {
  if (!rows_->next(row)) return false;
  findings_.examine(row, rows_->columns(), rows_->line());
  return true;
}

}  // namespace zerorate::recording
