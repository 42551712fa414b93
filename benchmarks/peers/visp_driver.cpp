// ViSP's trackers in a process of their own: benchmarks only, built by `.ci/setup-visp`, no part of the package.
// Usage: visp_driver FILE WIDTH HEIGHT; FILE is shared memory that holds the picture of the moment, 8 bit.
// Lines in: "ellipse X Y R RANGE STEP THRESHOLD" or "dot X Y RADIUS" to begin, "track" for each picture after it.
// Lines out: "NS X Y R", or "NS lost"; NS is the tracker's own time. "ready" at the start.
#include <chrono>
#include <cmath>
#include <fcntl.h>
#include <iostream>
#include <memory>
#include <string>
#include <sys/mman.h>
#include <vector>
#include <visp3/blob/vpDot2.h>
#include <visp3/me/vpMeEllipse.h>

int main(int, char **argv) {
    const unsigned width = std::stoul(argv[2]), height = std::stoul(argv[3]);
    void *shared = mmap(nullptr, size_t(width) * height, PROT_READ | PROT_WRITE, MAP_SHARED, open(argv[1], O_RDWR), 0);
    const vpImage<unsigned char> image(static_cast<unsigned char *>(shared), height, width);
    std::unique_ptr<vpMeEllipse> ellipse;
    std::unique_ptr<vpDot2> dot;
    vpMe sites;
    std::cout << "ready" << std::endl;
    for (std::string word; std::cin >> word;) {
        const auto begin = std::chrono::steady_clock::now();
        const auto ns = [&] { return (std::chrono::steady_clock::now() - begin).count(); };
        try {
            double x, y, r;
            if (word == "ellipse") {
                double range, step, threshold;
                std::cin >> x >> y >> r >> range >> step >> threshold;
                sites.setRange(unsigned(range)), sites.setSampleStep(step), sites.setThreshold(threshold);
                ellipse = std::make_unique<vpMeEllipse>(), dot.reset();
                ellipse->setMe(&sites);
                std::vector<vpImagePoint> rim;
                for (int k = 0; k < 8; k++) rim.emplace_back(y + r * std::sin(k * M_PI / 4), x + r * std::cos(k * M_PI / 4));
                ellipse->initTracking(image, rim);
                ellipse->track(image);
            } else if (word == "dot") {
                std::cin >> x >> y >> r;
                dot = std::make_unique<vpDot2>(), ellipse.reset();
                dot->setGraphics(false), dot->setComputeMoments(true);
                dot->setEllipsoidShapePrecision(0), dot->setSizePrecision(0.5), dot->setGrayLevelPrecision(0.8);
                dot->initTracking(image, vpImagePoint(y, x), unsigned(r));
            } else if (ellipse) {
                ellipse->track(image);
            } else {
                dot->track(image);
            }
            const vpImagePoint center = ellipse ? ellipse->getCenter() : dot->getCog();
            const double radius = ellipse ? (ellipse->get_ABE()[0] + ellipse->get_ABE()[1]) / 2 : std::sqrt(dot->m00 / M_PI);
            std::cout << ns() << ' ' << center.get_u() << ' ' << center.get_v() << ' ' << radius << std::endl;
        } catch (const std::exception &) {
            std::cout << ns() << " lost" << std::endl;
        }
    }
}
