// Rows of the table of claims: orientation and place on the sphere.
#include "claims.h"

namespace command_tests {

std::vector<ClaimRow> claims_of_place() {
  std::vector<ClaimRow> rows;
  // Orientation 3: the picture is turned by 180 degrees, which a single colour does not show; its rows do elsewhere.
  rows.push_back({"TIFF",
                  "orientation",
                  Becomes::honoured,
                  "turned.tif",
                  tiff(2, 1, 3, 32,
                       little_float(0.5F) + little_float(0.25F) + little_float(0.125F) + little_float(0.5F) +
                           little_float(0.25F) + little_float(0.125F),
                       {{339, 3, 3, little(3, 2) + little(3, 2) + little(3, 2)}, {274, 3, 1, little(3, 2)}}),
                  {0.5, 0.25, 0.125},
                  {"bottom"}});
  return rows;
}

}  // namespace command_tests
