"""The page of a structure: its bytes, and how it behaves in a browser, Chromium from a local file.

Figures are those that `exact`, `pockets` and `interface` print. Which atom is under the mouse is found here anew, by rays
against the spheres of the file.
"""

import csv
import io
import math
import os
import pathlib
import re

from program import BAD_INPUT, LIMIT_HIT, UBIQUITIN, ProgramTest, need_package, need_shared
from test_page import WAIT, start_browser

try:
    from PIL import Image
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import Select, WebDriverWait
except ImportError:  # View.setUpClass says which package is missing.
    pass

MEGABYTE = 1_000_000


def dimer(folder):
    """Ubiquitin and a copy of it that touches it, as chains A and B."""
    path = folder / "dimer.pdb"
    lines = [line for line in UBIQUITIN.read_text().splitlines() if line.startswith("ATOM") and line[77] != "H"]
    moved = [f"{line[:21]}B{line[22:30]}{float(line[30:38]) + 26:8.3f}{line[38:]}" for line in lines]
    path.write_text("\n".join([*lines, "TER", *moved, "TER", "END", ""]))
    return path


def text_of(number, decimals):
    return f"{number:,.{decimals}f}"


class Files(ProgramTest):
    """What needs no browser."""

    def test_bytes_do_not_depend_on_threads(self):
        path = dimer(self.folder)
        for surface in ("vdw", "ses"):
            made = []
            for threads in (1, 2):
                page = self.folder / f"{surface}{threads}.html"
                self.run_ok("view", path, "-o", page, "--surface", surface, "--threads", threads, "--page-triangles", 50000)
                made.append(page.read_bytes())
            self.assertEqual(made[0], made[1], surface)

    def test_the_page_asks_for_nothing(self):
        """Nothing leads elsewhere. What scripts might ask for would be an error in the console of the browser."""
        page = self.folder / "a.html"
        self.run_ok("view", UBIQUITIN, "-o", page)
        text = page.read_text()
        self.assertEqual(re.findall(r'(?:src|href)\s*=\s*["\']?\s*(?:https?:)?//', text), [])
        self.assertEqual(re.findall(r"<link|<img|@import|url\(", text.split("<script", 1)[0]), [])

    def test_haemoglobin_fits(self):
        structure = need_shared("molecules/thesis/4HHB.pdb")
        for surface in ("vdw", "ses"):
            page = self.folder / f"{surface}.html"
            self.run_ok("view", structure, "-o", page, "--surface", surface)
            self.assertLess(page.stat().st_size, 10 * MEGABYTE)

    def test_bad_input(self):
        page = self.folder / "a.html"
        self.assert_refused(BAD_INPUT, "view", UBIQUITIN, says=("-o", ".html"))
        self.assert_refused(BAD_INPUT, "view", UBIQUITIN, "-o", self.folder / "a.png", says=("-o", ".html"))
        self.assert_refused(BAD_INPUT, "view", self.folder / "nobody.pdb", "-o", page, says=("nobody.pdb",))
        self.assert_refused(BAD_INPUT, "view", UBIQUITIN, "-o", page, "--probe", "-2", says=("--probe",))
        self.assert_refused(LIMIT_HIT, "view", UBIQUITIN, "-o", page, "--memory-limit", "20M", says=("the stage",))
        self.assertFalse(page.exists())

    def test_remedies_are_options_of_the_verb(self):
        page = self.folder / "a.html"
        refused = self.assert_refused(LIMIT_HIT, "view", UBIQUITIN, "-o", page, "--memory-limit", "50M", says=("page",))
        options = set(re.findall(r"--[a-z-]+", refused.stderr))
        self.assertEqual(options, {"--page-triangles", "--memory-limit"})
        triangles = re.search(r"--page-triangles (\d+)", refused.stderr)[1]
        self.run_ok("view", UBIQUITIN, "-o", page, "--memory-limit", "50M", "--page-triangles", triangles)

    def test_few_triangles(self):
        """Where the creases alone need more than are wanted, marching cubes make fewer."""
        sizes = []
        for triangles in (200000, 60000, 5000):
            page = self.folder / f"{triangles}.html"
            text = self.run_ok("view", UBIQUITIN, "-o", page, "--page-triangles", triangles).stdout
            made = int(re.search(r"(\d+) triangles", text)[1])
            self.assertLess(made, 1.1 * triangles)
            sizes.append(page.stat().st_size)
        self.assertEqual(sizes, sorted(sizes, reverse=True))

    def test_structures_without_names_and_pockets(self):
        """Atoms without names, and one alone, which has neither pockets nor residues nor chains."""
        for name, spheres in {"two.xyzr": "0 0 0 2\n1.5 0 0 2\n", "one.xyzr": "0 0 0 1\n"}.items():
            page = self.folder / "a.html"
            self.run_ok("view", self.file(name, spheres), "-o", page)
            self.assertIn("<!doctype html>", page.read_text())


class View(ProgramTest):
    @classmethod
    def setUpClass(cls):
        """scripts/install-deps.sh browser installs the packages."""
        super().setUpClass()
        need_package("python3-selenium", module="selenium.webdriver")
        need_package("python3-pil", module="PIL.Image")
        need_package("chromium", program="chromium")
        need_package("chromium-driver", program="chromedriver")

    def open(self, *arguments):
        page = self.folder / "page.html"
        self.run_ok("view", *arguments, "-o", page)
        self.browser = start_browser(self.folder / "profile")
        self.addCleanup(self.browser.quit)
        self.load(page)
        return page

    def load(self, page):
        self.browser.get(page.as_uri())
        WebDriverWait(self.browser, WAIT).until(lambda b: b.execute_script("return document.body.dataset.drawn") == "yes",
                                                self.messages())  # fmt: skip

    def messages(self):
        """Errors in the console. WebGL in software gives warnings about its speed, which are none."""
        return [entry["message"] for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"]

    def find(self, selector):
        return self.browser.find_element(By.CSS_SELECTOR, selector)

    def all(self, selector):
        return self.browser.find_elements(By.CSS_SELECTOR, selector)

    def camera(self):
        return self.browser.execute_script("return state.viewer.camera.position.toArray()")

    def wait_for_flight(self):
        WebDriverWait(self.browser, WAIT).until(lambda b: self.find("#view").get_attribute("data-gliding") == "no")

    def assert_flies(self, act):
        """The camera ends elsewhere."""
        before = self.camera()
        self.browser.execute_script("document.getElementById('view').dataset.gliding = ''")
        act()
        self.wait_for_flight()
        self.assertGreater(math.dist(before, self.camera()), 5)

    def pixels(self):
        canvas = self.find("#view canvas")
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", canvas)
        return list(Image.open(io.BytesIO(canvas.screenshot_as_png)).convert("RGB").getdata())

    def assert_other_picture(self, act):
        before = self.pixels()
        act()
        after = self.pixels()
        self.assertGreater(sum(1 for a, b in zip(before, after) if a != b), len(before) * 0.02)

    def save_screenshot(self, name):
        """For people, where VDWMESH_SCREENSHOTS names a folder."""
        folder = os.environ.get("VDWMESH_SCREENSHOTS")
        if folder:
            self.browser.save_screenshot(str(pathlib.Path(folder) / name))

    def test_page(self):
        structure = dimer(self.folder)
        self.open(structure)
        self.check_figures(structure)
        self.check_spheres_of_pockets(structure)
        self.check_picking(structure)
        self.check_colors()
        self.check_lists(structure)
        self.check_plots(structure)
        self.check_keys()
        self.check_narrow_screen()
        self.assertEqual(self.messages(), [])
        self.assertFalse(self.find("#error").is_displayed())

    def check_figures(self, structure):
        exact = self.report("exact", structure)["exact"]
        rows = dict(line.split("\t") for line in self.browser.execute_script(
            "return [...document.querySelectorAll('#figures tbody tr')].map((r) => [...r.cells].map((c) => c.textContent).join('\\t'))"))  # fmt: skip
        self.assertEqual(rows["Exposed area, Å²"], text_of(exact["area"], 3))
        self.assertEqual(rows["Volume, Å³"], text_of(exact["volume"], 3))
        for title, key in (("Components", "components"), ("Tunnels", "tunnels"), ("Voids of this surface", "voids")):
            self.assertEqual(rows[title], text_of(exact[key], 0))
        data = self.browser.execute_script("return state.structure.exact")
        self.assertEqual((data["area"], data["volume"]), (exact["area"], exact["volume"]))

    def table(self, structure, group):
        path = self.folder / "atoms.csv"
        self.run_ok("exact", structure, "--per-atom", path, "--group", group, "--quiet")
        with path.open(newline="") as file:
            return list(csv.DictReader(file))

    def check_spheres_of_pockets(self, structure):
        path = self.folder / "spheres.pdb"
        self.run_ok("pockets", structure, "-o", path, "--quiet")
        lines = [line for line in path.read_text().splitlines() if line.startswith("HETATM")]
        wanted = [[float(line[k : k + n]) for k, n in ((30, 8), (38, 8), (46, 8), (60, 6))] for line in lines]
        numbers = self.browser.execute_script("return state.structure.pockets.flatMap((pocket) => pocket.spheres)")
        lower, upper = self.browser.execute_script("return [state.structure.mesh.lower, state.structure.mesh.upper]")
        middle = [(a + b) / 2 for a, b in zip(lower, upper)]  # places on the page are about it
        self.assertGreater(len(wanted), 0)
        self.assertEqual(len(numbers), 4 * len(wanted))
        for i, sphere in enumerate(wanted):
            for a, b, moved in zip(numbers[4 * i : 4 * i + 4], sphere, (*middle, 0)):
                self.assertAlmostEqual(a + moved, b, delta=0.006)

    def check_picking(self, structure):
        """At the middle of what is seen of an atom, the page names the atom that a ray meets first there."""
        rows = self.table(structure, "atom")
        spheres = [tuple(float(line[k : k + 8]) for k in (30, 38, 46)) for line in structure.read_text().splitlines()
                   if line.startswith("ATOM")]  # fmt: skip
        self.assertEqual(len(rows), len(spheres))
        radii = [float(row["radius"]) for row in rows]
        mouse = self.browser.execute_script("""
          const s = state.structure, box = document.querySelector('#view canvas').getBoundingClientRect();
          const middle = [0, 1, 2].map((k) => (s.mesh.lower[k] + s.mesh.upper[k]) / 2);
          const eye = state.viewer.camera.position.toArray().map((v, k) => v + middle[k]);
          const rays = [];
          for (let i = 2; i < 14; ++i) for (let j = 2; j < 10; ++j) {
            const x = Math.round(box.left + box.width * i / 16), y = Math.round(box.top + box.height * j / 12);
            const far = new THREE.Vector3(2 * (x - box.left) / box.width - 1, 1 - 2 * (y - box.top) / box.height, 0.5)
              .unproject(state.viewer.camera).toArray().map((v, k) => v + middle[k]);
            rays.push([x, y, eye, far]);
          }
          return rays;""")
        checked = 0
        for x, y, eye, far in mouse:
            length = math.dist(eye, far)
            way = [(b - a) / length for a, b in zip(eye, far)]
            hits = []
            for i, (center, radius) in enumerate(zip(spheres, radii)):
                to = [c - e for c, e in zip(center, eye)]
                along = sum(a * b for a, b in zip(to, way))
                beside = math.sqrt(max(0, sum(t * t for t in to) - along * along))
                if beside < radius:
                    hits.append((along - math.sqrt(radius * radius - beside * beside), beside / radius, i))
            hits.sort()
            # Near a crease or a rim a triangle may belong to the neighbour.
            if hits and (hits[0][1] > 0.7 or (len(hits) > 1 and hits[1][0] - hits[0][0] < 0.35)):
                continue
            builder = ActionChains(self.browser)
            builder.w3c_actions.pointer_action.move_to_location(x, y)
            builder.perform()
            self.browser.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(done))")
            tip = self.browser.execute_script("return document.getElementById('tip').hidden ? '' : document.getElementById('tip').textContent")
            if not hits:
                self.assertEqual(tip, "")
                continue
            row = rows[hits[0][2]]
            self.assertTrue(tip.startswith(f"{row['atom_name']} of {row['residue_name']} {row['residue_number']}, "
                                           f"chain {row['chain']}"), (tip, row))  # fmt: skip
            self.assertIn(f"atom {row['serial']}: {text_of(float(row['exact_area']), 2)} Å² exposed", tip)
            checked += 1
        self.assertGreater(checked, 3)

    def check_colors(self):
        choice = Select(self.find("#coloring"))
        self.assertEqual({o.get_attribute("value") for o in choice.options},
                         {"element", "chain", "residue", "area", "pocket", "plain"})  # fmt: skip
        seen = {}
        for option in ("element", "chain", "residue", "area", "pocket", "plain"):
            choice.select_by_value(option)
            seen[option] = self.pixels()
        for i, (name, one) in enumerate(seen.items()):
            for other_name, other in list(seen.items())[i + 1 :]:
                changed = sum(1 for a, b in zip(one, other) if a != b)
                self.assertGreater(changed, len(one) * 0.003, (name, other_name))
        self.assertTrue(any(r > 130 and g < 80 and b < 80 for r, g, b in seen["element"]), "oxygen is red")

    def check_lists(self, structure):
        pockets = self.report("pockets", structure)["pockets"]["pockets"]
        rows = self.all("#pockets tbody tr")
        self.assertEqual(len(rows), len(pockets))
        for row, pocket in zip(rows, pockets):
            cells = [c.text for c in row.find_elements(By.TAG_NAME, "td")]
            self.assertEqual(cells[:5], [str(pocket["rank"]), pocket["kind"], text_of(pocket["volume"], 2),
                                         text_of(pocket["area"], 2), str(pocket["mouths"])])  # fmt: skip
        self.assert_flies(rows[0].find_element(By.TAG_NAME, "button").click)
        self.save_screenshot("view-pocket.png")
        self.assertIn(text_of(pockets[0]["volume"], 3), self.find("#pocket-detail").text)
        lining = {tuple(name.split("/")[:2]) for name in pockets[0]["lining"].split()}
        self.assertEqual(len(self.all("#pocket-detail button")), len(lining))
        self.assert_flies(lambda: self.all("#pocket-detail button")[0].click())

        found = self.report("interface", structure)["interfaces"]
        rows = self.all("#interfaces tbody tr")
        self.assertEqual(len(rows), 1)
        self.assertGreater(found[0]["buried_area"], 100)
        cells = [c.text for c in rows[0].find_elements(By.TAG_NAME, "td")]
        self.assertEqual(cells[:3], ["A – B", text_of(found[0]["buried_area"], 2), text_of(found[0]["contact_area"], 2)])
        self.find("#whole").click()
        self.assert_other_picture(rows[0].find_element(By.TAG_NAME, "button").click)
        self.wait_for_flight()
        self.save_screenshot("view-interface.png")
        self.assertTrue(rows[0].find_element(By.TAG_NAME, "button").get_attribute("aria-pressed") == "true")

    def check_plots(self, structure):
        rows = self.table(structure, "residue")
        self.assertEqual(len(self.all("#plots svg")), 2)
        areas = self.browser.execute_script("return state.structure.residues.area")
        self.assertEqual(len(areas), len(rows))
        for area, row in zip(areas, rows):
            self.assertTrue(abs(area - float(row["exact_area"])) <= 1e-9, row)
        plot = self.find("#plots svg")
        plot.send_keys(Keys.ARROW_RIGHT * 5)
        row = rows[4]
        self.assertIn(f"{row['residue_name']} {row['residue_number']}", self.find("#picked").text)
        self.assertIn(text_of(float(row["exact_area"]), 2), self.find("#picked").text)
        self.assert_flies(lambda: plot.send_keys(Keys.ENTER))
        self.assert_flies(lambda: ActionChains(self.browser).move_to_element_with_offset(plot, 60, 0).click().perform())

    def check_keys(self):
        self.find("#clear").click()
        canvas = self.find("#view canvas")
        canvas.send_keys("0")
        before = self.camera()
        canvas.send_keys(Keys.ARROW_LEFT * 3 + "+")
        self.assertGreater(math.dist(before, self.camera()), 5)
        self.assertLess(math.hypot(*self.camera()), 0.9 * math.hypot(*before))
        canvas.send_keys("0")
        self.assertLess(math.dist(before, self.camera()), 1e-6)
        self.all("#pockets button")[0].send_keys(Keys.ENTER)
        self.assertTrue(self.all("#pockets tr.chosen"))
        self.find("body").send_keys(Keys.ESCAPE)
        self.assertEqual(self.all("#pockets tr.chosen"), [])
        # Tab reaches colour, view, lists and plots in this order, and what has the focus is seen.
        self.browser.execute_script("document.getElementById('coloring').focus()")
        reached = []
        for step in range(60):
            if step > 0:
                ActionChains(self.browser).send_keys(Keys.TAB).perform()
            reached.append(self.browser.execute_script(
                "const e = document.activeElement; return [e.id || e.tagName.toLowerCase() + ' in ' + "
                "(e.closest('[id]')?.id ?? ''), getComputedStyle(e).outlineStyle]"))  # fmt: skip
        names = [name for name, _ in reached]
        wanted = ["coloring", "whole", "canvas in view", "figures", "button in pockets", "button in interfaces", "svg in plots"]
        self.assertEqual([n for n in dict.fromkeys(names) if n in wanted], wanted)
        self.assertEqual({style for name, style in reached if name in wanted}, {"solid"})

    def check_narrow_screen(self):
        """On a phone nothing makes the page wider than the screen, in the light and in the dark."""
        for scheme in ("light", "dark"):
            self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                         {"features": [{"name": "prefers-color-scheme", "value": scheme}]})  # fmt: skip
            for width, height in ((1280, 1000), (390, 844)):
                self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                             {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500})  # fmt: skip
                WebDriverWait(self.browser, WAIT).until(
                    lambda b: b.execute_script("return document.documentElement.scrollWidth") == width)
                self.save_screenshot(f"view-{width}-{scheme}.png")
            background = max(set(pixels := self.pixels()), key=pixels.count)
            self.assertEqual(max(background) > 200, scheme == "light")
        self.browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})

    def test_excluded_surface(self):
        self.open(UBIQUITIN, "--surface", "ses")
        excluded = self.report("exact", UBIQUITIN, "--surface", "ses")["excluded"]["complete"]
        self.assertIn(text_of(excluded["area"], 3), self.find("#figures").text)
        self.assert_other_picture(lambda: Select(self.find("#coloring")).select_by_value("kind"))
        self.assertIn("saddle", self.find("#legend").text)
        total = self.browser.execute_script("return state.structure.atoms.area.reduce((a, b) => a + b, 0)")
        self.assert_close(total, excluded["area"], 1e-9)
        self.assertFalse(self.find("#interface-section").is_displayed())
        self.assertEqual(self.messages(), [])

    def test_without_webgl(self):
        """One line says so, and the tables are there."""
        page = self.open(UBIQUITIN)
        self.browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument",
                                     {"source": "HTMLCanvasElement.prototype.getContext = () => null;"})  # fmt: skip
        self.load(page)
        self.assertIn("WebGL", self.find("#view").text)
        self.assertEqual(len(self.find("#view").text.splitlines()), 1)
        self.assertTrue(self.all("#pockets tbody tr"))
        self.all("#pockets button")[0].click()
        self.assertTrue(self.find("#pocket-detail").is_displayed())
        self.assertFalse(self.find("#error").is_displayed())

    def test_names_are_texts(self):
        """A file may be named as badly as it likes."""
        bad = self.file('a & b <b>"c".xyzr', "0 0 0 2\n1.5 0 0 2\n")
        self.open(bad)
        self.assertEqual(self.find("#name").text, bad.name)
        self.assertEqual(self.messages(), [])
