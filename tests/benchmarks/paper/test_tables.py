"""The paper's figures and the tables that hold them beside ours."""

import unittest

import published
import tables


def rows_of(text):
    """{first cell: the others} of a Markdown table."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")]
            for line in text.splitlines() if line.startswith("| ")]
    return {row[0]: row[1:] for row in rows}


class Published(unittest.TestCase):
    def test_average_is_the_mean_of_the_four(self):
        for column in [*published.TABLE_I.values(),
                       *published.TABLE_I_PEERS.values()]:
            self.assertAlmostEqual(sum(column[:4]) / 4, column[4], delta=1e-4)

    def test_share_avoided_follows_from_the_counts(self):
        self.assertEqual(tuple(published.TABLE_II), published.DTU_SCANS)
        for before, after, share in published.TABLE_II.values():
            self.assertAlmostEqual(tables.avoided(before, after), share,
                                   delta=0.06)

    def test_shares_grow_with_the_threshold(self):
        for scene in published.TABLE_III:
            for peer in [*published.TABLE_III_PEERS.values(),
                         published.TABLE_III]:
                self.assertLess(peer[scene][0], peer[scene][1])


class Tables(unittest.TestCase):
    def test_cells_and_means(self):
        self.assertEqual(tables.cell(None, 4), "-")
        self.assertEqual(tables.cell(0.35244, 4), "0.3524")
        self.assertEqual(tables.cell(0, 0), "0")
        self.assertEqual(tables.mean([1, None, 3]), 2)
        self.assertIsNone(tables.mean([None]))
        self.assertIsNone(tables.avoided(0, 0))
        self.assertIsNone(tables.avoided(None, None))

    def test_nothing_computed_prints_no_figure_of_ours(self):
        for results in ({"paper": {}}, {"paper": {"all": {4: None}}}):
            for text in (tables.table_1(results), tables.table_3(
                    {"paper": {}})):
                ours = {title: cells for title, cells in rows_of(text).items()
                        if title.startswith("ours")}
                self.assertEqual(len(ours), 4)
                for cells in ours.values():
                    self.assertTrue(set(cells) <= {"-", "0"})
        ours = rows_of(tables.table_2({"paper": {}}))
        self.assertEqual(set(ours["ours, paper: % avoided"]), {"-"})
        self.assertEqual(set(ours["ours, paper: fixing"]), {"-"})

    def test_table_1_is_the_mean_over_the_evaluated_scans(self):
        rows = rows_of(tables.table_1({"default": {"initial": {
            4: [1, 2, 3, 4, 2.5], 6: [3, 4, 5, 6, 4.5], 15: None}}}))
        self.assertEqual(rows["ours, default: initial mesh"],
                         ["2.0000", "3.0000", "4.0000", "5.0000", "3.5000",
                          "2"])
        self.assertEqual(rows["ours, default: all"], ["-"] * 5 + ["0"])
        self.assertEqual(rows["paper: all"],
                         ["0.4092", "0.2067", "0.4958", "0.2980", "0.3524",
                          "12"])
        self.assertEqual(rows["Romanoni 2019"][-2:], ["0.4221", "12"])

    def test_table_2_has_the_paper_s_rows_and_ours(self):
        rows = rows_of(tables.table_2({"paper": {4: (50, 5), 63: (7, None)}}))
        self.assertEqual(rows["paper: w/o fixing"][:3], ["52", "84", "69"])
        self.assertEqual(rows["paper: % avoided"][-1], "90.6")
        self.assertEqual(rows["ours, paper: w/o fixing"][0], "50")
        self.assertEqual(rows["ours, paper: % avoided"],
                         ["90.0"] + ["-"] * 11 + ["90.0"])

    def test_table_3_keeps_scenes_apart(self):
        rows = rows_of(tables.table_3({"default": {
            "initial": {"fountain": [0.7, 0.9]},
            "all": {"fountain": None, "herzjesu": [0.6, 0.8]}}}))
        self.assertEqual(rows["ours, default: initial mesh"],
                         ["0.700", "0.900", "-", "-"])
        self.assertEqual(rows["ours, default: all"],
                         ["-", "-", "0.600", "0.800"])
        self.assertEqual(rows["paper: all"],
                         ["0.825", "0.946", "0.738", "0.928"])

    def test_every_row_is_as_long_as_the_head(self):
        for text in (tables.table_1({"a": {}, "b": {}}),
                     tables.table_2({"a": {}, "b": {}}),
                     tables.table_3({"a": {}, "b": {}})):
            lengths = {line.count("|") for line in text.splitlines()
                       if line.startswith("|")}
            self.assertEqual(len(lengths), 1)


if __name__ == "__main__":
    unittest.main()
