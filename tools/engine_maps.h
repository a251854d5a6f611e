// The maps of an engine, made of a probe.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "engines.h"
#include "envmap/map/rows.h"
#include "envmap/prefilter/prefilter.h"

namespace tools {

/// A map as it goes into its file. The rows may read `levels`.
struct MadeMap {
  envmap::EnvironmentMap levels;
  std::vector<envmap::Rows> rows;
  std::map<std::string, std::string> pairs;  ///< For WriteOptions::pairs.
  envmap::Facts facts;
};

/// Makes the maps of engines out of one probe; what several want of it is prepared once.
class MapMaker {
 public:
  /// @param source must outlive this.
  /// @param size of maps of one level. @param chain_size of the first level of chains.
  MapMaker(const envmap::EnvironmentMap& source, std::optional<int> size, std::optional<int> chain_size, const Common& common);

  [[nodiscard]] MadeMap make(const EngineMap& wanted);

 private:
  [[nodiscard]] MadeMap environment(const envmap::Frame& frame, std::optional<int> size) const;
  [[nodiscard]] MadeMap chain(const EngineMap& wanted);
  [[nodiscard]] MadeMap diffuse(const EngineMap& wanted);
  const envmap::PrefilterSource& prepared();

  const envmap::EnvironmentMap& source_;
  std::optional<int> size_, chain_size_;
  const Common& common_;
  std::unique_ptr<envmap::PrefilterSource> prepared_;
};

}  // namespace tools
