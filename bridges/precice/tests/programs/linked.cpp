// A program that was linked with preCICE's own library: its class is declared, not inline, and its
// methods are symbols of the library. It exchanges the data of dummy.xml, and checks what it reads.

#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

namespace precice {

template <typename T, std::size_t Extent> struct span {
  T *first;
  std::size_t length;
};
template <typename T> using list = span<T, static_cast<std::size_t>(-1)>;

class Participant {
public:
  Participant(list<const char> name, list<const char> file, int rank, int size);
  ~Participant();
  void initialize();
  void advance(double step);
  bool isCouplingOngoing() const;
  double getMaxTimeStepSize() const;
  int getDataDimensions(list<const char> mesh, list<const char> data) const;
  void setMeshVertices(list<const char> mesh, list<const double> places, list<int> ids);
  void writeData(list<const char> mesh, list<const char> data, list<const int> ids,
                 list<const double> values);
  void readData(list<const char> mesh, list<const char> data, list<const int> ids, double time,
                list<double> values) const;

private:
  void *hidden = nullptr;
};

std::string getVersionInformation();

} // namespace precice

static precice::list<const char> text(const std::string &word) { return {word.data(), word.size()}; }

int main(int, char **arguments) {
  const std::string name = arguments[1], other = name == "One" ? "Two" : "One";
  const std::string mesh = name + "-Mesh", scalar = "Scalar-" + name, vector = "Vector-" + name;
  precice::Participant participant(text(name), text(arguments[2]), 0, 1);
  std::vector<double> places(6), values(2), vectors(6), read(6);
  std::vector<int> ids(2);
  places[3] = 1;
  participant.setMeshVertices(text(mesh), {places.data(), 6}, {ids.data(), 2});
  if (ids[1] != 1 || participant.getDataDimensions(text(mesh), text(vector)) != 3) {
    return 1;
  }
  participant.initialize();
  const std::string others = "Vector-" + other;
  const double sign = name == "One" ? 1 : -1;
  for (int window = 1; participant.isCouplingOngoing(); window++) {
    for (int i = 0; i < 6; i++) {
      vectors[i] = sign * (10 * window + i);
    }
    values = {sign, sign};
    participant.writeData(text(mesh), text(scalar), {ids.data(), 2}, {values.data(), 2});
    participant.writeData(text(mesh), text(vector), {ids.data(), 2}, {vectors.data(), 6});
    participant.advance(participant.getMaxTimeStepSize());
    if (!participant.isCouplingOngoing()) {
      break;
    }
    participant.readData(text(mesh), text(others), {ids.data(), 2}, 0, {read.data(), 6});
    for (int i = 0; i < 6; i++) {
      if (read[i] != -vectors[i]) {
        std::fprintf(stderr, "window %d: %g instead of %g\n", window, read[i], -vectors[i]);
        return 1;
      }
    }
  }
  std::printf("%s: %s\n", arguments[1], precice::getVersionInformation().c_str());
  return 0;
}
