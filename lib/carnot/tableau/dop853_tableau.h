// Coefficients of the explicit method of order 8 with 12 stages of the code DOP853, due to Dormand
// & Prince; neither symplectic nor symmetric. Here with constant steps, so without the embedded
// methods of order 5 and 3.
//
// Source: Hairer, Norsett & Wanner, Solving ODEs I, II.10, and the code that goes with it, which
// prints a_ij and b_i to thirty digits. The nodes are known exactly: c_2, ..., c_5 from
// (6 -+ sqrt 6)/30, the others rational. b_2, ..., b_5 vanish.
#pragma once

#include <array>
#include <cmath>
#include <string_view>

#include "carnot/numerics/coefficients.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

struct Dop853Entry {
  int i;  // from 1; 13 for b
  int j;
  std::string_view value;
};

// a_ij; those not listed vanish.
inline constexpr std::array<Dop853Entry, 58> kDop853 = {
    {{2, 1, "0.0526001519587677318785587544488"},
     {3, 1, "0.0197250569845378994544595329183"},
     {3, 2, "0.0591751709536136983633785987549"},
     {4, 1, "0.0295875854768068491816892993775"},
     {4, 3, "0.0887627564304205475450678981324"},
     {5, 1, "0.241365134159266685502369798665"},
     {5, 3, "-0.884549479328286085344864962717"},
     {5, 4, "0.924834003261792003115737966543"},
     {6, 1, "0.037037037037037037037037037037"},
     {6, 4, "0.170828608729473871279604482173"},
     {6, 5, "0.125467687566822425016691814123"},
     {7, 1, "0.037109375"},
     {7, 4, "0.170252211019544039314978060272"},
     {7, 5, "0.0602165389804559606850219397283"},
     {7, 6, "-0.017578125"},
     {8, 1, "0.0370920001185047927108779319836"},
     {8, 4, "0.170383925712239993810214054705"},
     {8, 5, "0.107262030446373284651809199168"},
     {8, 6, "-0.0153194377486244017527936158236"},
     {8, 7, "0.00827378916381402288758473766002"},
     {9, 1, "0.624110958716075717114429577812"},
     {9, 4, "-3.36089262944694129406857109825"},
     {9, 5, "-0.868219346841726006818189891453"},
     {9, 6, "27.5920996994467083049415600797"},
     {9, 7, "20.1540675504778934086186788979"},
     {9, 8, "-43.4898841810699588477366255144"},
     {10, 1, "0.477662536438264365890433908527"},
     {10, 4, "-2.48811461997166764192642586468"},
     {10, 5, "-0.590290826836842996371446475743"},
     {10, 6, "21.2300514481811942347288949897"},
     {10, 7, "15.2792336328824235832596922938"},
     {10, 8, "-33.2882109689848629194453265587"},
     {10, 9, "-0.0203312017085086261358222928593"},
     {11, 1, "-0.93714243008598732571704021658"},
     {11, 4, "5.18637242884406370830023853209"},
     {11, 5, "1.09143734899672957818500254654"},
     {11, 6, "-8.14978701074692612513997267357"},
     {11, 7, "-18.5200656599969598641566180701"},
     {11, 8, "22.7394870993505042818970056734"},
     {11, 9, "2.49360555267965238987089396762"},
     {11, 10, "-3.0467644718982195003823669022"},
     {12, 1, "2.27331014751653820792359768449"},
     {12, 4, "-10.5344954667372501984066689879"},
     {12, 5, "-2.00087205822486249909675718444"},
     {12, 6, "-17.9589318631187989172765950534"},
     {12, 7, "27.9488845294199600508499808837"},
     {12, 8, "-2.85899827713502369474065508674"},
     {12, 9, "-8.87285693353062954433549289258"},
     {12, 10, "12.3605671757943030647266201528"},
     {12, 11, "0.643392746015763530355970484046"},
     {13, 1, "0.0542937341165687622380535766363"},
     {13, 6, "4.45031289275240888144113950566"},
     {13, 7, "1.89151789931450038304281599044"},
     {13, 8, "-5.8012039600105847814672114227"},
     {13, 9, "0.31116436695781989440891606237"},
     {13, 10, "-0.152160949662516078556178806805"},
     {13, 11, "0.201365400804030348374776537501"},
     {13, 12, "0.0447106157277725905176885569043"}}};

template <class T>
Tableau<T> dop853_tableau() {
  using Wide = Wider<T>;
  using std::sqrt;
  constexpr int s = 12;
  Tableau<T> tableau;
  tableau.order = 8;
  tableau.coupling = Coupling::kExplicit;
  tableau.b = StageVector<T, kAnyStages>::Zero(s);
  tableau.mu = StageMatrix<T, kAnyStages>::Zero(s, s);
  StageVector<Wide, kAnyStages> omega = StageVector<Wide, kAnyStages>::Ones(s);
  for (const Dop853Entry& entry : kDop853) {
    if (entry.i <= s) continue;
    omega[entry.j - 1] = decimal<Wide>(entry.value);
    tableau.b[entry.j - 1] = T(omega[entry.j - 1]);
  }
  for (const Dop853Entry& entry : kDop853) {
    if (entry.i > s) continue;
    const Wide a = decimal<Wide>(entry.value);
    tableau.mu(entry.i - 1, entry.j - 1) = T(a / omega[entry.j - 1]);
  }
  const auto ratio = [](int numerator, int denominator) {
    return T(Wide(numerator) / Wide(denominator));
  };
  const Wide root = sqrt(Wide(6));
  const Wide c4 = (Wide(6) - root) / Wide(30);
  tableau.c.resize(s);
  tableau.c << T(0), T(c4 * Wide(4) / Wide(9)), T(c4 * Wide(2) / Wide(3)), T(c4),
      T((Wide(6) + root) / Wide(30)), ratio(1, 3), ratio(1, 4), ratio(4, 13), ratio(127, 195),
      ratio(3, 5), ratio(6, 7), T(1);
  set_weights(tableau);
  return tableau;
}

}  // namespace carnot
