// A folder that appears whole or not at all.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/files/commit.h"

namespace envmap {

/// Files on their way to a folder: they are written into a hidden one beside it, which commit() gives the name. What
/// was there under that name is replaced in one step. Without commit() nothing is left, nor where a signal ends the
/// program. Where it is killed, the hidden folder is left, and the next OutputFolder of that name removes it: it is
/// locked while its owner lives (flock()). File systems that cannot lock folders (NFS) keep it.
/// NAME.import and NAME.meta, which engines write beside a file NAME, are kept while there is NAME. Missing parents are
/// made.
class OutputFolder {
 public:
  /// @param files all that it will hold. @param earlier files that may be there from before, and go.
  /// @throws UsageError where there is a folder that holds others, or another file of that name; OutputError where
  /// there can be none.
  OutputFolder(std::string path, std::span<const std::string> files, std::span<const std::string> earlier,
               const CommitOptions& how);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write a file of it.
  [[nodiscard]] std::string file(std::string_view name) const;
  /// An error of writing it, with the name that the file shall have.
  [[nodiscard]] OutputError with_final_path(const OutputError& e, std::string_view name) const;
  /// Writes a text as one.
  void write(std::string_view name, std::string_view text) const;

  /// Makes the folder appear. @throws OutputError.
  void commit();

 private:
  [[nodiscard]] bool is_there_already() const;
  void check_entries() const;

  void make_parents(const std::filesystem::path& parent);
  void keep_companions() const;
  void make_hidden(const std::string& stem);
  void take_name();
  [[nodiscard]] bool rename_plainly(bool exchange);

  std::string path_, target_, hidden_;        // As it was named, without links, and until commit().
  int lock_ = -1;                             // The hidden folder, open and locked.
  std::vector<std::string> files_, earlier_;
  std::vector<std::string> parents_;          // Folders made for it, the innermost first.
  std::vector<std::string> pending_;          // What a signal removes.
  CommitOptions how_;
};

}  // namespace envmap
