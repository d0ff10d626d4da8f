"""The page of a study in a browser: Chromium, driven by ChromeDriver, from a local file."""

import io
import os
import pathlib

from program import ProgramTest, need_package

try:
    from PIL import Image
    from selenium import webdriver
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import Select, WebDriverWait
except ImportError:  # Page.setUpClass says which package is missing.
    pass

WAIT = 120  # s: WebGL is software here
PLOTS_PER_MOLECULE = 5 * 2 + 3 + 2  # convergence, quality, costs


def start_browser(profile):
    options = webdriver.ChromeOptions()
    options.binary_location = need_package("chromium", program="chromium")
    for argument in ("--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader",
                     "--window-size=1280,1000", "--hide-scrollbars", "--disable-dev-shm-usage",
                     "--host-resolver-rules=MAP * ~NOTFOUND",
                     f"--user-data-dir={profile}"):  # fmt: skip
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = need_package("chromium-driver", program="chromedriver")
    service = webdriver.chrome.service.Service(driver)
    return webdriver.Chrome(service=service, options=options)


class Page(ProgramTest):
    @classmethod
    def setUpClass(cls):
        """scripts/install-deps.sh browser installs the packages."""
        super().setUpClass()
        need_package("python3-selenium", module="selenium.webdriver")
        need_package("python3-pil", module="PIL.Image")
        need_package("chromium", program="chromium")
        need_package("chromium-driver", program="chromedriver")

    def setUp(self):
        super().setUp()
        out = self.folder / "out"
        self.run_ok("study", self.two_balls(), "--sample", "ubiquitin", "-o", out,
                    "--spacing", "1,0.7", "--field", "vdw,blinn", "--edge-length", "1,0.7")  # fmt: skip
        self.browser = start_browser(self.folder / "profile")
        self.addCleanup(self.browser.quit)
        self.browser.get((out / "index.html").as_uri())
        self.wait_until_drawn(0)

    def two_balls(self):
        return self.file('a & b <b>"c".xyzr', "0 0 0 2\n1.5 0 0 2\n")

    def wait_until_drawn(self, molecule):
        body = self.browser.find_element(By.TAG_NAME, "body")
        WebDriverWait(self.browser, WAIT).until(
            lambda _: body.get_attribute("data-drawn") == str(molecule), self.messages()
        )

    def messages(self):
        """Errors in the console. WebGL in software gives warnings about its speed, which are none."""
        log = self.browser.get_log("browser")
        return [entry["message"] for entry in log if entry["level"] == "SEVERE"]

    def plots(self):
        return self.browser.find_elements(By.CSS_SELECTOR, ".plots > div[data-drawn]")

    def count_marks(self, plot):
        return len(plot.find_elements(By.CSS_SELECTOR, ".mark-symbol path, .mark-area path"))

    def pixels(self):
        """The 3D view as it is on the screen, (r, g, b) by (r, g, b)."""
        canvas = self.browser.find_element(By.CSS_SELECTOR, "#view canvas")
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", canvas)
        return list(Image.open(io.BytesIO(canvas.screenshot_as_png)).convert("RGB").getdata())

    def test_page(self):
        self.check_names()
        Select(self.browser.find_element(By.ID, "molecule")).select_by_visible_text("ubiquitin")
        self.wait_until_drawn(1)
        self.save_screenshots()
        self.assertEqual(len(self.plots()), PLOTS_PER_MOLECULE)
        for plot in self.plots():
            self.assertGreater(self.count_marks(plot), 0, plot.get_attribute("data-drawn"))
        self.check_orders_are_stated()
        self.check_labels_lie_apart()
        self.check_exact_figures()
        self.check_view()
        self.check_keys()
        self.check_colors()
        self.check_narrow_screen()
        self.assertEqual(self.messages(), [])
        error = self.browser.find_element(By.ID, "error")
        self.assertFalse(error.is_displayed(), error.text)

    def check_orders_are_stated(self):
        plot = self.browser.find_element(By.CSS_SELECTOR, "div[data-drawn='Area error against spacing']")
        labels = [e.text for e in plot.find_elements(By.CSS_SELECTOR, ".mark-text text")]
        self.assertTrue(any(label.startswith("p = ") for label in labels), labels)
        rows = self.browser.find_elements(By.CSS_SELECTOR, "#orders tbody tr")
        # Two fields, not subdivided; vdw once and Blinn twice, once; crease-exact not subdivided and once.
        self.assertEqual(len(rows), 7)

    def check_labels_lie_apart(self):
        """No two texts of a plot touch, and no label lies on a mark of a line."""
        overlaps = """
          const apart = (a, b) => a.right <= b.left + 1 || b.right <= a.left + 1 || a.bottom <= b.top + 1 ||
            b.bottom <= a.top + 1;
          const found = [];
          for (const plot of document.querySelectorAll('.plots > div[data-drawn]')) {
            const boxes = (s) => [...plot.querySelectorAll(s)].filter((e) => e.getAttribute('opacity') !== '0')
              .map((e) => [e.textContent, e.getBoundingClientRect()]).filter(([text, box]) => box.width > 0);
            const texts = boxes('text');
            texts.forEach(([text, a], i) => texts.slice(i + 1).forEach(([other, b]) => {
              if (!apart(a, b)) found.push([plot.dataset.drawn, text, other]);
            }));
            const points = boxes('.mark-symbol.symbols path');
            const labels = texts.filter(([t]) => t.startsWith('p = '));
            if (labels.length > 0 && points.length === 0) found.push([plot.dataset.drawn, 'no points']);
            for (const [text, a] of labels)
              for (const [, b] of points)
                if (!apart(a, b)) found.push([plot.dataset.drawn, text, 'a point']);
          }
          return found;"""
        self.assertEqual(self.browser.execute_script(overlaps), [])

    def check_exact_figures(self):
        """Beside the mesh in 3D stand the exact figures: those of `vdwmesh exact`."""
        cells = [c.text for c in self.browser.find_elements(By.CSS_SELECTOR, "#scene-table tbody td")]
        exact = self.report("exact", "--sample", "ubiquitin")["exact"]
        self.assertEqual(cells[0:12:4], ["Area, Å²", "Volume, Å³", "Components"])
        self.assertEqual(cells[2], f"{exact['area']:,.3f}")
        self.assertEqual(cells[6], f"{exact['volume']:,.3f}")

    def check_keys(self):
        """The arrow keys turn the mesh, and 0 puts it back."""
        canvas = self.browser.find_element(By.CSS_SELECTOR, "#view canvas")
        canvas.send_keys("0")
        before = self.pixels()
        canvas.send_keys(Keys.ARROW_LEFT * 3 + "+")
        turned = self.pixels()
        canvas.send_keys("0")
        self.assertGreater(sum(1 for a, b in zip(before, turned) if a != b), len(before) * 0.05)
        self.assertEqual(self.pixels(), before)

    def check_narrow_screen(self):
        """On a phone, nothing makes the page wider than the screen, and plots are made anew for it."""
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                     {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": True})  # fmt: skip
        widest = "return Math.max(...[...document.querySelectorAll('.plots svg')].map((e) => e.clientWidth))"
        WebDriverWait(self.browser, WAIT).until(lambda b: len(self.plots()) == PLOTS_PER_MOLECULE
                                                and b.execute_script(widest) <= 390)  # fmt: skip
        self.assertEqual(self.browser.execute_script("return document.documentElement.scrollWidth"), 390)
        self.check_labels_lie_apart()
        self.browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})

    def check_view(self):
        before = self.pixels()
        colored = sum(1 for p in before if max(p) - min(p) > 20)
        background = sum(1 for p in before if p == (255, 255, 255))
        self.assertGreater(colored, len(before) * 0.02)
        self.assertGreater(background, len(before) * 0.2)
        canvas = self.browser.find_element(By.CSS_SELECTOR, "#view canvas")
        ActionChains(self.browser).drag_and_drop_by_offset(canvas, 200, 60).perform()
        after = self.pixels()
        changed = sum(1 for a, b in zip(before, after) if a != b)
        self.assertGreater(changed, len(before) * 0.05)

    def check_colors(self):
        seen = [self.pixels()]
        for coloring in ("atom", "angle"):
            Select(self.browser.find_element(By.ID, "coloring")).select_by_value(coloring)
            seen.append(self.pixels())
        for i, one in enumerate(seen):
            for other in seen[i + 1 :]:
                changed = sum(1 for a, b in zip(one, other) if a != b)
                self.assertGreater(changed, len(one) * 0.05)
        # Oxygen is red and nitrogen blue.
        atoms = seen[1]
        self.assertTrue(any(r > 150 and g < 80 and b < 80 for r, g, b in atoms))
        self.assertTrue(any(b > 150 and r < 100 and g < 130 for r, g, b in atoms))

    def check_names(self):
        """A file may be named as badly as it likes."""
        name = self.browser.find_element(By.CSS_SELECTOR, "#molecule-table tbody td").text
        self.assertEqual(name, 'a & b <b>"c".xyzr')
        self.assertEqual(len(self.plots()), PLOTS_PER_MOLECULE)

    def save_screenshots(self):
        """For people: of the whole page, where VDWMESH_SCREENSHOTS names a folder."""
        folder = os.environ.get("VDWMESH_SCREENSHOTS")
        if not folder:
            return
        height = self.browser.execute_script("return document.body.scrollHeight")
        self.browser.set_window_size(1280, height + 150)
        self.browser.save_screenshot(str(pathlib.Path(folder) / "page.png"))
        self.browser.set_window_size(1280, 1000)
