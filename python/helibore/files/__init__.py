"""Formats: the bytes of a file to plain sets of channels, and tables back to bytes.

    delimited.py  CSV, TSV, ; and | tables      las.py       LAS 2.0, LAS 3.0        json_log.py  JSON Well Log Format
    columnar.py   Parquet, NPZ                  dlis.py      DLIS (RP66 V1)          witsml.py    WITSML 1.4.1.1
    spreadsheet.py  XLSX                        lis.py       LIS79

``reading.read_file`` finds the format and reads. What a channel means is decided in ``helibore.channels``.
"""
