"""Read files of all supported formats into plain sets of channels, and write tables to files.

    delimited.py  CSV, TSV, ; and | tables      las.py       LAS 2.0, LAS 3.0        json_log.py  JSON Well Log Format
    columnar.py   Parquet, NPZ                  dlis.py      DLIS (RP66 V1)          witsml_log.py    WITSML 1.4.1.1
    spreadsheet.py  XLSX                        lis.py       LIS79

``reading.read_file`` finds the format and reads the file. ``helibore.channels`` decides what each channel means.
"""
