"""The figures of the paper, as printed.

A. Romanoni, M. Matteucci, "Facetwise Mesh Refinement for Multi-View Stereo",
tables I (DTU), II (singular vertices), III (EPFL).
"""

# The 12 scans of tables I and II; the first seven of 49 images, the others of
# 64, all of 1600 x 1200 px.
DTU_SCANS = (4, 6, 15, 18, 24, 36, 63, 106, 110, 114, 118, 122)

# Table I: means over the scans, mm. The heads of the last columns but one miss
# a "w/o"; the text has it.
DTU_METRICS = ("mean_accuracy", "median_accuracy", "mean_completeness",
               "median_completeness", "average")
TABLE_I_PEERS = {
    "Campbell 2008": (1.8857, 0.7490, 0.4213, 0.2856, 0.8354),
    "Furukawa 2009": (0.9126, 0.3973, 0.5330, 0.3517, 0.5486),
    "Tola 2012": (0.4455, 0.2256, 0.7317, 0.3511, 0.4385),
    "Li 2016": (0.4245, 0.2193, 0.7252, 0.3426, 0.4279),
    "Romanoni 2019": (0.4087, 0.2150, 0.7237, 0.3413, 0.4221),
}
TABLE_I = {  # by ablation
    "initial": (0.4669, 0.2195, 0.5200, 0.3292, 0.3839),
    "no_fixing": (0.4116, 0.2121, 0.5044, 0.3039, 0.3580),
    "whole_mesh": (0.4298, 0.2113, 0.5005, 0.3010, 0.3607),
    "all": (0.4092, 0.2067, 0.4958, 0.2980, 0.3524),
}

# Table II: singular vertices without and with preemptive fixing, and the
# share avoided, per cent, by scan.
TABLE_II = {
    4: (52, 10, 80.8), 6: (84, 10, 88.1), 15: (69, 8, 88.4),
    18: (585, 65, 88.9), 24: (122, 14, 88.5), 36: (219, 14, 93.6),
    63: (41, 0, 100.0), 106: (99, 10, 89.9), 110: (74, 9, 87.8),
    114: (24, 1, 95.8), 118: (54, 2, 96.3), 122: (47, 5, 89.4),
}

# Table III: share of the ground-truth depths with an error below 2 cm, 10 cm.
EPFL_THRESHOLDS = (0.02, 0.1)  # m
TABLE_III_PEERS = {
    "Zheng 2014": {"fountain": (0.769, 0.929), "herzjesu": (0.650, 0.844)},
    "Hu 2012": {"fountain": (0.754, 0.930), "herzjesu": (0.649, 0.848)},
    "Furukawa 2010": {"fountain": (0.731, 0.838), "herzjesu": (0.646, 0.836)},
    "Galliani 2015": {"fountain": (0.693, 0.838), "herzjesu": (0.283, 0.455)},
    "Schoenberger 2016": {"fountain": (0.827, 0.975),
                          "herzjesu": (0.691, 0.931)},
    "Zaharescu 2007": {"fountain": (0.712, 0.832), "herzjesu": (0.220, 0.501)},
    "Tylecek 2010": {"fountain": (0.732, 0.822), "herzjesu": (0.658, 0.852)},
    "Jancosek 2011": {"fountain": (0.824, 0.973), "herzjesu": (0.739, 0.923)},
}
TABLE_III = {"fountain": (0.825, 0.946), "herzjesu": (0.738, 0.928)}
